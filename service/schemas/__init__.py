"""What goes in and out over HTTP, as pydantic models: for validation and for the OpenAPI document."""
