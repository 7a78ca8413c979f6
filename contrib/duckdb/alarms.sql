-- Alarms by cause: how often, on how many machines, when last, and the words of that time.
SELECT event_alarm AS alarm, count(*) AS times, count(DISTINCT machine) AS machines, max(at_utc) AS last,
       arg_max(event_cause, at_utc) AS cause, arg_max(event_remedy, at_utc) AS remedy
FROM told('event') WHERE event_kind = 'alarm'
GROUP BY alarm
ORDER BY times DESC, alarm;
