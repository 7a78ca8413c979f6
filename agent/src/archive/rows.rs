//! Records of one kind as a file of Parquet. Its columns are the metrics that a broker gets of them: `Thread/RMS Error` in
//! µm is `thread_rms_error_um`.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::Origin;
use crate::record::{Body, Moment, Numbered};
use crate::sparkplug::metrics::{Row, TABLE, of_record};
use crate::sparkplug::payload::{Kind, Metric, Value};

/// What is left out of the metrics: the number has a column of its own, and the kind stands in the path.
const RECORD: &str = "Record/";

/// The values of a column, one for each row; `None` where it is not known.
#[derive(Debug)]
enum Cells {
    Texts(Vec<Option<ByteArray>>),
    Numbers(Vec<Option<i64>>),
    /// Milliseconds since 1970, UTC.
    Times(Vec<Option<i64>>),
    Fractions(Vec<Option<f64>>),
    Flags(Vec<Option<bool>>),
}

#[derive(Debug)]
struct Column {
    name: String,
    cells: Cells,
}

/// The file of records that are all of one kind.
///
/// # Errors
/// They are not.
pub fn file(origin: &Origin, made: Moment, records: &[&Numbered]) -> Result<Vec<u8>> {
    let columns = columns(origin, made, records)?;
    let schema = schema(&columns)?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(format!("leadscrew {}", env!("CARGO_PKG_VERSION")))
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for column in columns {
        column.write(&mut group)?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

fn columns(origin: &Origin, made: Moment, records: &[&Numbered]) -> Result<Vec<Column>> {
    let text = |text: &str| Some(ByteArray::from(text));
    let all = |cell: Option<ByteArray>| Cells::Texts(vec![cell; records.len()]);
    let machines = records.iter().map(|record| text(&record.record.machine));
    let times = records.iter().map(|record| Some(time(record.record.at)));
    let numbers = records
        .iter()
        .map(|record| Some(record.number.cast_signed()));
    let mut columns = vec![
        column("at_utc", Cells::Times(times.collect())),
        column("shop", all(text(&origin.shop))),
        column("node", all(text(&origin.node))),
        column("machine", Cells::Texts(machines.collect())),
        column("store", Cells::Times(vec![Some(time(made)); records.len()])),
        column("number", Cells::Numbers(numbers.collect())),
    ];
    columns.extend(keys(records));
    let first = columns.len();
    for (row, record) in records.iter().enumerate() {
        let metrics = of_record(record, 0, false);
        let metrics = metrics.iter().filter_map(of_table);
        let metrics = metrics.filter(|(of, _)| !of.name.starts_with(RECORD));
        let mut count = first;
        for (of, metric) in metrics {
            if row == 0 {
                columns.push(column(&name(of.name, of.unit), Cells::of(of.kind)));
            }
            let column = columns.get_mut(count).ok_or_else(mixed)?;
            column.cells.push(of.kind, metric.value.as_ref());
            count += 1;
        }
        if count != columns.len() {
            return Err(mixed());
        }
    }
    Ok(columns)
}

/// The parts of a key as numbers, by which a thread is joined with its run: taking texts apart is slow in a database
/// [D437].
fn keys(records: &[&Numbered]) -> Vec<Column> {
    let part = |name: &str, of: fn(&Body) -> Option<u32>| {
        let cells = records.iter().map(|record| of(&record.record.body));
        let cells: Vec<_> = cells.map(|part| part.map(i64::from)).collect();
        let is_known = cells.iter().any(Option::is_some);
        is_known.then(|| column(name, Cells::Numbers(cells)))
    };
    let start = |body: &Body| match body {
        Body::Thread(thread) => Some(thread.start.count),
        Body::Run(run) => Some(run.start.count),
        _ => None,
    };
    let program = |body: &Body| match body {
        Body::Run(run) => Some(run.program),
        _ => None,
    };
    [part("start", start), part("run_program", program)]
        .into_iter()
        .flatten()
        .collect()
}

fn mixed() -> ParquetError {
    ParquetError::General("records of two kinds in one file".to_owned())
}

fn of_table(metric: &Metric) -> Option<(&'static Row, &Metric)> {
    let place = usize::try_from(metric.alias?).ok()?;
    Some((TABLE.get(place)?, metric))
}

const fn time(at: Moment) -> i64 {
    at.0.cast_signed()
}

fn column(name: &str, cells: Cells) -> Column {
    Column {
        name: name.to_owned(),
        cells,
    }
}

/// A name that no database needs quotes for. A unit that is no word is left out: those of ticks stand in the page.
fn name(metric: &str, unit: &str) -> String {
    let mut name = metric.to_ascii_lowercase().replace(['/', ' '], "_");
    let unit = match unit {
        "µm" => "um",
        "mm" => "mm",
        "%" => "percent",
        "1/min" => "rpm",
        _ => return name,
    };
    // The uncertainty of a figure in µm is `..._um_u`.
    let end = name.strip_suffix("_u").map(str::len);
    match end {
        Some(end) => name.insert_str(end, &format!("_{unit}")),
        None => name.push_str(&format!("_{unit}")),
    }
    name
}

impl Cells {
    const fn of(kind: Kind) -> Self {
        match kind {
            Kind::String => Self::Texts(Vec::new()),
            Kind::Boolean => Self::Flags(Vec::new()),
            Kind::Double => Self::Fractions(Vec::new()),
            Kind::DateTime => Self::Times(Vec::new()),
            _ => Self::Numbers(Vec::new()),
        }
    }

    fn push(&mut self, kind: Kind, value: Option<&Value>) {
        match self {
            Self::Texts(cells) => cells.push(match value {
                Some(Value::String(text)) => Some(ByteArray::from(text.as_str())),
                _ => None,
            }),
            Self::Flags(cells) => cells.push(match value {
                Some(Value::Boolean(flag)) => Some(*flag),
                _ => None,
            }),
            Self::Fractions(cells) => cells.push(match value {
                Some(Value::Double(number)) => Some(*number),
                _ => None,
            }),
            Self::Numbers(cells) | Self::Times(cells) => cells.push(match value {
                // Below zero as two's complement.
                Some(Value::Int(number)) if kind == Kind::Int32 => {
                    Some(number.cast_signed().into())
                }
                Some(Value::Int(number)) => Some((*number).into()),
                Some(Value::Long(number)) => Some(number.cast_signed()),
                _ => None,
            }),
        }
    }

    fn types(&self) -> (Physical, Option<LogicalType>) {
        match self {
            Self::Texts(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Self::Numbers(_) => (Physical::INT64, None),
            // Without a time zone: a database takes it as it stands, and needs no table of zones.
            Self::Times(_) => (
                Physical::INT64,
                Some(LogicalType::timestamp(false, TimeUnit::MILLIS)),
            ),
            Self::Fractions(_) => (Physical::DOUBLE, None),
            Self::Flags(_) => (Physical::BOOLEAN, None),
        }
    }
}

impl Column {
    fn write(self, group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>) -> Result<()> {
        match self.cells {
            Cells::Texts(cells) => write::<ByteArrayType>(group, cells),
            Cells::Numbers(cells) | Cells::Times(cells) => write::<Int64Type>(group, cells),
            Cells::Fractions(cells) => write::<DoubleType>(group, cells),
            Cells::Flags(cells) => write::<BoolType>(group, cells),
        }
    }
}

fn write<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>,
    cells: Vec<Option<T::T>>,
) -> Result<()> {
    let known: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    let values: Vec<T::T> = cells.into_iter().flatten().collect();
    let mut column = group.next_column()?.ok_or_else(mixed)?;
    column
        .typed::<T>()
        .write_batch(&values, Some(&known), None)?;
    column.close()
}

fn schema(columns: &[Column]) -> Result<TypePtr> {
    let field = |column: &Column| {
        let (physical, logical) = column.cells.types();
        let field = Type::primitive_type_builder(&column.name, physical)
            .with_logical_type(logical)
            .with_repetition(Repetition::OPTIONAL);
        field.build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_>>()?;
    let schema = Type::group_type_builder("record").with_fields(fields);
    schema.build().map(Arc::new)
}
