"""An archive, read with DuckDB by the files of `contrib/duckdb`."""

import pathlib

import duckdb

FOLDER = pathlib.Path(__file__).parents[2] / "contrib" / "duckdb"


class Archive:
    """A folder that agents write."""

    def __init__(self, folder, threads=2):
        self.database = duckdb.connect()
        self.database.execute(f"SET threads = {threads}")
        self.set("archive", str(folder))
        self.database.execute((FOLDER / "archive.sql").read_text())

    def set(self, name, value):
        text = str(value).replace("'", "''")
        value = value if isinstance(value, int) else f"'{text}'"
        self.database.execute(f"SET VARIABLE {name} = {value}")

    def does(self, text):
        """Carries out a query, and gives its rows as dictionaries."""
        result = self.database.execute(text)
        names = [column[0] for column in result.description]
        return [dict(zip(names, row)) for row in result.fetchall()]

    def query(self, name):
        """The same with a file of `contrib/duckdb`."""
        return self.does((FOLDER / f"{name}.sql").read_text())
