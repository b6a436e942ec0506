"""SDF 1.4 to 1.12: links, joints and frames placed relative to each other, nested models.

Source: http://sdformat.org/spec
"""
