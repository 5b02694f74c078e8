"""The source, figure by figure: its numbers beside ours, and an honest verdict."""
