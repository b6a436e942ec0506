"""What a person sees: the catalogue, a part, a tree. Plain HTML, self-contained, not part of the API."""
