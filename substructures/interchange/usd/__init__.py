"""USD: rigid bodies and joints of UsdPhysics, in metres, kilograms and radians, with the third axis upwards.

Source: https://openusd.org/release/api/usd_physics_page_front.html
"""
