"""Which inertial parameters a motion depends on, and their values from measurements."""
