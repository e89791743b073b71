"""Files of others, each as the dict that a structure file has: drawings, and compas assemblies.

A file is data from a stranger: its size is bounded before it is read, nothing in it is
followed or run, and what is wrong is one `InputError`.
"""
