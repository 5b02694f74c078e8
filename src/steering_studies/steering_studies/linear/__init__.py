"""Linear analysis and controller design: each study is a function that returns arrays and figures.

The command ``steer linear`` draws them; docs/linear.md says what they show.
"""
