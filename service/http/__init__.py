"""What every request passes through: reading, keys, idempotency, deadlines, problem documents."""
