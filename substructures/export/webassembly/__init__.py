"""WebAssembly: a module of straight-line code, made byte by byte."""
