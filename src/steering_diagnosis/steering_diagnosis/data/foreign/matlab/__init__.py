"""MATLAB files of any version: vectors, found by an address as MATLAB writes it."""

from steering_diagnosis.data.foreign.matlab.reader import read_matlab

__all__ = ["read_matlab"]
