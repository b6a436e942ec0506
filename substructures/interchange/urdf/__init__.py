"""URDF: links with inertial origins, joints with axes in any direction, transmissions.

Source: http://wiki.ros.org/urdf/XML
"""
