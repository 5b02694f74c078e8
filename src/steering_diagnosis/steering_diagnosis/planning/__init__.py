"""The experiment that would tell apart what a record cannot."""
