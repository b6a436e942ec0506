"""The database: connections, tables, migrations, backup. SQL itself is in ``service.queries``."""
