"""All SQL. Functions take a connection inside a transaction that ``service.database`` has begun; none commits."""
