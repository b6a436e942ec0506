"""Alembic migrations, one file a schema version; ``service.migrate`` runs them when the server starts."""
