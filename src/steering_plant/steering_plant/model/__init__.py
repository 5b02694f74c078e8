"""The plant's equations as compiled kernels.

The modules import each other relatively, so that the whole folder can be compiled again beside a
``slots`` module that adds chosen effects (steering_core.specialise).
"""
