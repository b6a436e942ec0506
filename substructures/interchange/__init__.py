"""Foreign documents in: robot files (URDF, ...) to definitions, with a report of what became of everything in them.

==============  ====================================================================================================
module          what is there
==============  ====================================================================================================
kinds           which format a file has, and its reader
xml, numbers    elements with their lines, exact numbers
urdf            one reader for each format, all to ``robot.Robot``
robot, merge    links on parents with motions between them; links that do not move against each other as one
as_part         a robot as the definition of a substructure
importing       all of it: bytes to definition, report, checks and names
==============  ====================================================================================================
"""
