"""The processes of a server: a parent that starts them, how they share connections and threads, how they end."""
