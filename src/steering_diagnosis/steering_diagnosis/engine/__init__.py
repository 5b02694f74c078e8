"""The engine: inference over any model written as balances. It knows no steering gear."""
