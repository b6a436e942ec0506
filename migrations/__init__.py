"""Alembic migrations, one file a schema version; ``service.database.migrate`` runs them when the server starts."""
