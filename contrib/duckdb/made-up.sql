-- Certificates that nobody has cut, for trying how fast a query is: an archive of 200 machines in the year 2026, a file for
-- each month. Ten of them are of one part; each part has its run.
--
--     SET VARIABLE archive = 'made-up';
--     SET VARIABLE certificates = 10000000;
CREATE OR REPLACE TEMP MACRO spread(i, salt) AS hash(i * 31 + salt) % 1000000 / 1e6;

COPY (
    SELECT 'thread' AS record, date_trunc('month', at_utc)::DATE AS date, * REPLACE (date_trunc('millisecond', at_utc) AS at_utc)
    FROM (
        SELECT TIMESTAMP '2026-01-01' + to_seconds(31535999.0 * i / getvariable('certificates')) AS at_utc,
               'made-up' AS shop, 'desk' AS node, 'lathe' || (i // 10 % 200) AS machine, TIMESTAMP '2026-01-01' AS store,
               i + 1 AS number, 1 AS start,
               printf('%08x/1/%d', 40960 + i // 10 % 200, i // 2000 * 10 + i % 10) AS thread_key,
               i // 2000 AS thread_program, 10 + i % 10 AS thread_line,
               CASE WHEN i % 10 < 7 THEN 'thread' ELSE 'rigid_tap' END AS thread_kind, 'finished' AS thread_end,
               5 AS thread_passes, 0 AS thread_late, 4000 AS thread_measured,
               4 + 3 * spread(i, 1) AS thread_largest_error_um,
               -- The spindle of lathe7 gets worse by a µm in a month.
               1 + spread(i, 2) + CASE WHEN i // 10 % 200 = 7 THEN 12.0 * i / getvariable('certificates') ELSE 0 END
                   AS thread_rms_error_um,
               CASE WHEN i % 10 < 7 THEN 'yes' ELSE 'hole' END AS cut_known, NULL::VARCHAR AS cut_why,
               CASE WHEN i % 10 < 7 THEN 1.5 END AS cut_lead_mm,
               CASE WHEN i % 10 < 7 THEN 6 * spread(i, 3) - 3 END AS cut_lead_error_um,
               CASE WHEN i % 10 < 7 THEN 0.8 END AS cut_lead_error_um_u,
               CASE WHEN i % 10 < 7 THEN 20 * spread(i, 4) - 10 END AS cut_worst_um,
               CASE WHEN i % 10 < 7 THEN 2.0 END AS cut_worst_um_u
        FROM range(getvariable('certificates')) AS made(i)
    )
) TO (getvariable('archive')) (FORMAT parquet, PARTITION_BY (record, date), APPEND);

COPY (
    SELECT 'run' AS record, date_trunc('month', at_utc)::DATE AS date, *
    FROM (
        SELECT TIMESTAMP '2026-01-01' + to_milliseconds(31535999000 * (i + 1) // (getvariable('certificates') // 10 + 1)) AS at_utc,
               'made-up' AS shop, 'desk' AS node, 'lathe' || (i % 200) AS machine, TIMESTAMP '2026-01-01' AS store,
               getvariable('certificates') + i + 1 AS number, 1 AS start, i // 200 AS run_program,
               printf('%08x/1/%d', 40960 + i % 200, i // 200) AS run_key, true AS run_finished, 60000 AS run_ticks,
               printf('%016x', i % 3) AS run_setpoint_hash, 0 AS run_late, 40000 AS run_measured,
               7.0 AS run_largest_error_um, 1.5 AS run_rms_error_um
        FROM range(getvariable('certificates') // 10) AS made(i)
    )
) TO (getvariable('archive')) (FORMAT parquet, PARTITION_BY (record, date), APPEND);
