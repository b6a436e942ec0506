"""Names that variables in generated code do not have."""

from __future__ import annotations

_WORDS = (
    "t q qd qdd u x p w work pi i j e d np math model sign auto break case char const continue default do double else",
    "enum extern float for goto if inline int long register restrict return short signed sizeof static struct",
    "switch typedef union unsigned void volatile while and as assert async await class def del elif except false",
    "finally from global import in is lambda none nonlocal not or pass raise true try with yield match type",
    "function end otherwise parfor persistent spmd classdef catch let local macro module quote using baremodule",
    "begin export abstract mutable primitive where outer nan inf zeros ones sin cos tan asin acos atan atan2 exp",
    "log sqrt abs fabs pow batch inputs outputs sign_of integer rational symbol mutabledensendimarray",
    "immutabledensendimarray main list len dict isinstance valueerror size_t real result program subroutine",
    "contains implicit intent use fn mut pub impl crate self super loop move ref trait unsafe dyn box final",
    "override typeof virtual block part output input array matrix vector table first last rest length nil numel",
    "error nargin limit limits",
)
#: words of languages, and what generated code uses, in small letters
RESERVED = frozenset(word for line in _WORDS for word in line.split())
#: functions of mathematical libraries that a variable would hide
IN_HEADERS = ("y0", "y1", "yn", "j0", "j1", "jn", "gamma", "lgamma", "tgamma", "drem", "index", "beta", "load", "time")
