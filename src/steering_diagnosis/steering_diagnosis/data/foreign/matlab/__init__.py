"""MATLAB files of any version, from what the file holds to the channels that a mapping names."""

from steering_diagnosis.data.foreign.matlab.reader import read_matlab

__all__ = ["read_matlab"]
