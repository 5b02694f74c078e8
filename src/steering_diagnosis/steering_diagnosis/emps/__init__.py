"""A real electro-mechanical axis as a model for the engine: the EMPS benchmark."""
