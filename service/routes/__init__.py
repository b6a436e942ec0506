"""One file a resource; an endpoint reads its request, calls operations and shapes the answer."""
