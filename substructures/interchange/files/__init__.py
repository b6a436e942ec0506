"""Files from outside as bytes: what they are, what lies about them, meshes."""
