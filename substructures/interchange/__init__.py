"""Foreign documents in: robot files to definitions, with a report of what became of everything in them; comparisons.

==================  ================================================================================================
module              what is there
==================  ================================================================================================
importing           all of it: bytes to definition (or tree), report, checks and names
kinds               which format a file has, and its reader
urdf, mjcf, sdf     readers of XML formats, to ``robot.Robot``; ``known``: the names that each of them has
usd                 reader of USD files with UsdPhysics, to the same
rows                readers of Denavit-Hartenberg tables and SYMORO files, straight to definitions
robot, merge        links on parents with motions between them; links that do not move against each other as one
bindings            coordinates that follow others: mimic joints
as_part, names      a robot as the definition of a substructure; names of files as names of definitions
report              remarks with their lines; what is lost is kept in definitions as ``left_out``
cut                 a robot that is cut at named links as several definitions and a tree
equivalence         whether two models are the same; ``culprits``: which body and parameter is not
symbolic            SymPy in and out: expressions, equations, systems of bodies and joints
files               what bytes are, what lies about a robot file in a folder or a zip, masses of meshes
xml, numbers        elements with their lines and exact numbers; ``rotations`` and inertias as doubles
==================  ================================================================================================
"""
