"""The languages of functions on the calling convention, a :class:`.code.Code` each."""
