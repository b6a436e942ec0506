"""Numbers of many states as files and streams: npz and Arrow, for the service and for its client."""
