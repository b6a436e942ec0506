"""The first schema: content (programs, parts, formulas), names (versions, aliases, trees), keys."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create all tables."""
    op.create_table(
        "api_keys",
        sa.Column("id", sa.Text(), nullable=False),
        sa.Column("secret_hash", sa.Text(), nullable=False),
        sa.Column("label", sa.Text(), nullable=False),
        sa.Column("scopes", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.Column("expires", sa.Text(), nullable=True),
        sa.Column("revoked", sa.Text(), nullable=True),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_api_keys")),
    )
    op.create_table(
        "idempotency",
        sa.Column("principal", sa.Text(), nullable=False),
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("fingerprint", sa.Text(), nullable=False),
        sa.Column("owner", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.Column("status", sa.Integer(), autoincrement=False, nullable=True),
        sa.Column("headers", sa.Text(), nullable=True),
        sa.Column("body", sa.LargeBinary(), nullable=True),
        sa.PrimaryKeyConstraint("principal", "key", name=op.f("pk_idempotency")),
    )
    op.create_index(op.f("ix_idempotency_created"), "idempotency", ["created"], unique=False)
    op.create_table(
        "programs",
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.Column("nodes", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("digest", name=op.f("pk_programs")),
    )
    op.create_table(
        "substructures",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("latest", sa.Integer(), autoincrement=False, nullable=True),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_substructures")),
    )
    op.create_table(
        "tree_names",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("latest", sa.Integer(), autoincrement=False, nullable=False),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_tree_names")),
    )
    op.create_table(
        "parts",
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("program", sa.Text(), nullable=False),
        sa.Column("definition", sa.Text(), nullable=False),
        sa.Column("title", sa.Text(), nullable=False),
        sa.Column("description", sa.Text(), nullable=False),
        sa.Column("tags", sa.Text(), nullable=False),
        sa.Column("searchable", sa.Text(), nullable=False),
        sa.Column("dof", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("joints", sa.Text(), nullable=False),
        sa.Column("coordinates", sa.Text(), nullable=False),
        sa.Column("bodies", sa.Text(), nullable=False),
        sa.Column("ports", sa.Text(), nullable=False),
        sa.Column("parameters", sa.Text(), nullable=False),
        sa.Column("operations", sa.Text(), nullable=False),
        sa.Column("certificate", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["program"], ["programs.digest"], name=op.f("fk_parts_program_programs")),
        sa.PrimaryKeyConstraint("digest", name=op.f("pk_parts")),
    )
    op.create_table(
        "trees",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("revision", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("spec", sa.Text(), nullable=False),
        sa.Column("program", sa.Text(), nullable=False),
        sa.Column("dof", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("summary", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.Column("based_on", sa.Integer(), autoincrement=False, nullable=True),
        sa.ForeignKeyConstraint(["name"], ["tree_names.name"], name=op.f("fk_trees_name_tree_names")),
        sa.ForeignKeyConstraint(["program"], ["programs.digest"], name=op.f("fk_trees_program_programs")),
        sa.PrimaryKeyConstraint("name", "revision", name=op.f("pk_trees")),
    )
    op.create_index(op.f("ix_trees_created"), "trees", ["created"], unique=False)
    op.create_index(op.f("ix_trees_digest"), "trees", ["digest"], unique=False)
    op.create_table(
        "formulas",
        sa.Column("part", sa.Text(), nullable=False),
        sa.Column("position", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("quantity", sa.Text(), nullable=False),
        sa.Column("body", sa.Text(), nullable=True),
        sa.Column("coordinate", sa.Text(), nullable=True),
        sa.Column("shape", sa.Text(), nullable=False),
        sa.Column("symmetry", sa.Text(), nullable=False),
        sa.Column("operations", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("output", sa.Text(), nullable=False),
        sa.Column("entry", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["part"], ["parts.digest"], name=op.f("fk_formulas_part_parts")),
        sa.PrimaryKeyConstraint("part", "position", name=op.f("pk_formulas")),
    )
    op.create_index(
        op.f("ix_formulas_part_quantity_body_coordinate"),
        "formulas",
        ["part", "quantity", "body", "coordinate"],
        unique=False,
    )
    op.create_table(
        "tags",
        sa.Column("part", sa.Text(), nullable=False),
        sa.Column("tag", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["part"], ["parts.digest"], name=op.f("fk_tags_part_parts")),
        sa.PrimaryKeyConstraint("part", "tag", name=op.f("pk_tags")),
    )
    op.create_table(
        "tree_parts",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("revision", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("instance", sa.Text(), nullable=False),
        sa.Column("part", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["name", "revision"], ["trees.name", "trees.revision"], name=op.f("fk_tree_parts_name_revision_trees")
        ),
        sa.ForeignKeyConstraint(["part"], ["parts.digest"], name=op.f("fk_tree_parts_part_parts")),
        sa.PrimaryKeyConstraint("name", "revision", "instance", name=op.f("pk_tree_parts")),
    )
    op.create_index(op.f("ix_tree_parts_part"), "tree_parts", ["part"], unique=False)
    op.create_table(
        "versions",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("version", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("digest", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.Column("yanked", sa.Text(), nullable=True),
        sa.Column("yank_reason", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(["digest"], ["parts.digest"], name=op.f("fk_versions_digest_parts")),
        sa.ForeignKeyConstraint(["name"], ["substructures.name"], name=op.f("fk_versions_name_substructures")),
        sa.PrimaryKeyConstraint("name", "version", name=op.f("pk_versions")),
        sa.UniqueConstraint("digest", name=op.f("uq_versions_digest")),
    )
    op.create_index(op.f("ix_versions_created"), "versions", ["created"], unique=False)
    op.create_table(
        "aliases",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("alias", sa.Text(), nullable=False),
        sa.Column("version", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("revision", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("changed", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["name", "version"], ["versions.name", "versions.version"], name=op.f("fk_aliases_name_version_versions")
        ),
        sa.PrimaryKeyConstraint("name", "alias", name=op.f("pk_aliases")),
    )
    op.create_table(
        "alias_history",
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("alias", sa.Text(), nullable=False),
        sa.Column("revision", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("version", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("changed", sa.Text(), nullable=False),
        sa.Column("principal", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["name", "alias"], ["aliases.name", "aliases.alias"], name=op.f("fk_alias_history_name_alias_aliases")
        ),
        sa.PrimaryKeyConstraint("name", "alias", "revision", name=op.f("pk_alias_history")),
    )
