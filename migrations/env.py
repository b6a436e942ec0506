"""Alembic environment: runs on the connection and in the transaction of ``service.database.migrate``.

New version: ``alembic.command.revision`` with this folder as ``script_location``, or copy the newest file of
``versions`` and raise its number. On SQLite alter tables with ``op.batch_alter_table``; foreign keys are switched off
around it by ``service.database.migrate``. The tests compare the migrated schema with ``service.database.tables``.
"""

from __future__ import annotations

from alembic import context

context.configure(
    connection=context.config.attributes["connection"],
    transactional_ddl=True,  # SQLite can, and service.database.migrate has begun the transaction itself
    render_as_batch=True,
)
context.run_migrations()
