"""A real electro-mechanical positioning axis as a model to diagnose: the engine on other ground.

A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, Nonlinear System
Identification Benchmarks (2019). The measured records are not part of the project.
"""
