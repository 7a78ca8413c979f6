-- A month of a kind as one file, for an archive of many small ones. Into another folder; move it to its place and remove
-- the days once it is there. It stands under the first day of its month, and is read like the others.
--
--     SET VARIABLE month = DATE '2026-11-01';
--     SET VARIABLE kind = 'thread';
--     SET VARIABLE months = 'months';
COPY (
    SELECT * REPLACE (getvariable('month') AS date)
    FROM once(getvariable('kind'))
    WHERE date_trunc('month', date) = getvariable('month')
    ORDER BY machine, at_utc
) TO (getvariable('months'))
(FORMAT parquet, PARTITION_BY (record, date), FILENAME_PATTERN 'month-{uuid}', APPEND);
