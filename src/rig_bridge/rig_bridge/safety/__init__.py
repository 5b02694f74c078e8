"""Keeps a rig safe: pure state machine, watchdogs and limits. Nothing here reads a clock."""
