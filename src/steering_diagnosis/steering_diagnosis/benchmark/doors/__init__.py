"""The doors through which a case comes in: kinds of files, what is measured, how it is recorded."""
