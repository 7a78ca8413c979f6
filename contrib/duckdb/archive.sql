-- What the other files here build upon: the records of an archive that `leadscrew agent --archive DIR` writes.
--
--     SET VARIABLE archive = 'history';
--     .read contrib/duckdb/archive.sql
--     .read contrib/duckdb/alarms.sql

-- The records of a kind. An agent writes each of them once.
CREATE OR REPLACE MACRO records(kind) AS TABLE
FROM read_parquet(getvariable('archive') || '/record=' || kind || '/*/*.parquet', hive_partitioning = true);

-- The same where files were copied twice, or a store was put back from a copy: no number is given twice by a store, and
-- no key to two certificates. It takes longer. To have all queries read so:
--
--     CREATE OR REPLACE MACRO told(kind) AS TABLE FROM once(kind);
CREATE OR REPLACE MACRO once(kind) AS TABLE
SELECT DISTINCT ON (shop, node, store, number) * FROM records(kind);

-- What the queries read.
CREATE OR REPLACE MACRO told(kind) AS TABLE FROM records(kind);

-- The key of the run that a thread belongs to: serial number of the board, its start, and the number of the program.
CREATE OR REPLACE MACRO run_of(thread_key, program) AS
    split_part(thread_key, '/', 1) || '/' || split_part(thread_key, '/', 2) || '/' || program;

-- Which tool cuts which line of which program, as the shop knows it: no certificate names a tool. A program is known by the
-- hash of its setpoints, which is another where it begins from another place, and at each run where threads follow a real
-- spindle (docs/agent.md). Empty where the shop says nothing.
--
--     INSERT INTO tools SELECT * FROM 'tools.csv';
CREATE TABLE IF NOT EXISTS tools (setpoint_hash VARCHAR, line BIGINT, tool VARCHAR);
