"""MJCF: the mechanics of a MuJoCo model, without contacts.

Source: https://mujoco.readthedocs.io/en/stable/XMLreference.html
"""
