"""The paper's experiments, done again on our shapes: `make figures`, or `python -m figures` in docs/.

Source: Rustamov, Lipman and Funkhouser 2009, sections 6 and 7. One module a group of figures; each figure
is a function that is entered in `figures.registry.FIGURES`, saves one picture and returns one table.
"""
