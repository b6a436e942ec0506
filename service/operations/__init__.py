"""The use cases. They compute first and then write everything in one transaction that the caller gives."""
