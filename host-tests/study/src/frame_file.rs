//! Frames in Parquet files.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use parquet::basic::{Repetition, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{BoolType, DoubleType, FloatType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::{Column, Frame};

fn physical(column: &Column) -> Physical {
    match column {
        Column::Integer(_) => Physical::INT64,
        Column::Real(_) => Physical::DOUBLE,
        Column::Single(_) => Physical::FLOAT,
        Column::Flag(_) => Physical::BOOLEAN,
    }
}

fn schema(frame: &Frame) -> parquet::errors::Result<Type> {
    let field = |(name, column): &(String, Column)| {
        Type::primitive_type_builder(name, physical(column))
            .with_repetition(Repetition::REQUIRED)
            .build()
            .map(Arc::new)
    };
    let fields = frame.columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("flights")
        .with_fields(fields)
        .build()
}

/// Writes frames of the same columns, each as a row group of one Parquet file.
pub struct FrameWriter<W: Write + Send> {
    /// Open from the first frame on, which has the columns.
    writer: Option<SerializedFileWriter<W>>,
    to: Option<W>,
    metadata: Option<Vec<KeyValue>>,
}

impl<W: Write + Send> FrameWriter<W> {
    /// A writer of the file `to`.
    pub fn new(to: W) -> Self {
        Self {
            writer: None,
            to: Some(to),
            metadata: None,
        }
    }

    /// A writer of the file `to`, with `value` under `key` in its metadata.
    pub fn with_metadata(to: W, key: &str, value: String) -> Self {
        Self {
            metadata: Some(vec![KeyValue::new(key.to_owned(), value)]),
            ..Self::new(to)
        }
    }

    /// Writes `frame`.
    pub fn write(&mut self, frame: &Frame) -> anyhow::Result<()> {
        if let Some(to) = self.to.take() {
            let schema = Arc::new(schema(frame)?);
            let properties = WriterProperties::builder();
            let properties = properties.set_key_value_metadata(self.metadata.take());
            let writer = SerializedFileWriter::new(to, schema, Arc::new(properties.build()))?;
            self.writer = Some(writer);
        }
        let writer = self.writer.as_mut().expect("made with the first frame");
        let mut group = writer.next_row_group()?;
        for (_, column) in &frame.columns {
            let mut to = group.next_column()?.context("more columns than before")?;
            match column {
                Column::Integer(v) => to.typed::<Int64Type>().write_batch(v, None, None)?,
                Column::Real(v) => to.typed::<DoubleType>().write_batch(v, None, None)?,
                Column::Single(v) => to.typed::<FloatType>().write_batch(v, None, None)?,
                Column::Flag(v) => to.typed::<BoolType>().write_batch(v, None, None)?,
            };
            to.close()?;
        }
        group.close()?;
        Ok(())
    }

    /// Ends the file.
    pub fn close(self) -> anyhow::Result<()> {
        if let Some(writer) = self.writer {
            writer.close()?;
        }
        Ok(())
    }
}

/// The frame in the file `path`, all of its row groups in one.
pub fn read(path: &Path) -> anyhow::Result<Frame> {
    let read = || {
        let reader = SerializedFileReader::new(File::open(path)?)?;
        let fields = reader.metadata().file_metadata().schema_descr_ptr();
        let mut frame = Frame::default();
        for (i, field) in fields.columns().iter().enumerate() {
            let mut column = match field.physical_type() {
                Physical::INT64 => Column::Integer(Vec::new()),
                Physical::DOUBLE => Column::Real(Vec::new()),
                Physical::FLOAT => Column::Single(Vec::new()),
                Physical::BOOLEAN => Column::Flag(Vec::new()),
                other => bail!("column {} is {other}", field.name()),
            };
            for group in 0..reader.num_row_groups() {
                let group = reader.get_row_group(group)?;
                append(&*group, i, &mut column)?;
            }
            frame.push(field.name(), column);
        }
        Ok(frame)
    };
    read().with_context(|| path.display().to_string())
}

fn append(group: &dyn RowGroupReader, i: usize, to: &mut Column) -> anyhow::Result<()> {
    let rows = usize::try_from(group.metadata().num_rows())?;
    let (records, ..) = match (group.get_column_reader(i)?, to) {
        (ColumnReader::Int64ColumnReader(mut from), Column::Integer(to)) => {
            from.read_records(rows, None, None, to)?
        }
        (ColumnReader::DoubleColumnReader(mut from), Column::Real(to)) => {
            from.read_records(rows, None, None, to)?
        }
        (ColumnReader::FloatColumnReader(mut from), Column::Single(to)) => {
            from.read_records(rows, None, None, to)?
        }
        (ColumnReader::BoolColumnReader(mut from), Column::Flag(to)) => {
            from.read_records(rows, None, None, to)?
        }
        _ => bail!("column {i} changes its type"),
    };
    anyhow::ensure!(records == rows, "column {i} ends early");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.parquet");
        let frame = |n: i64| {
            let mut frame = Frame::default();
            let range = || (0..n).map(|i| i * n);
            frame.push("flight", Column::Integer(range().collect()));
            let reals = range().map(|i| i as f64 / 7.0);
            frame.push("vehicle.mass_kg", Column::Real(reals.collect()));
            let singles = range().map(|i| if i == 0 { f32::NAN } else { i as f32 });
            frame.push("t_s", Column::Single(singles.collect()));
            frame.push(
                "departed",
                Column::Flag(range().map(|i| i % 3 == 0).collect()),
            );
            frame
        };
        let mut writer = FrameWriter::new(File::create(&path).unwrap());
        writer.write(&frame(5)).unwrap();
        writer.write(&frame(3)).unwrap();
        writer.close().unwrap();
        let back = read(&path).unwrap();
        assert_eq!(back.rows(), 8);
        assert_eq!(back.integer("flight").unwrap(), [0, 5, 10, 15, 20, 0, 3, 6]);
        assert_eq!(back.real("vehicle.mass_kg").unwrap()[7], 6.0 / 7.0);
        assert!(back.single("t_s").unwrap()[5].is_nan());
        assert!(back.flag("departed").unwrap()[7]);
        assert!(back.real("flight").is_err() && back.real("x").is_err());
    }

    /// A file that ends in the middle is an error that names it.
    #[test]
    fn half_a_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("half.parquet");
        let mut frame = Frame::default();
        frame.push("a", Column::Real(vec![1.0; 1000]));
        let mut bytes = Vec::new();
        let mut writer = FrameWriter::new(&mut bytes);
        writer.write(&frame).unwrap();
        writer.close().unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        let error = format!("{:#}", read(&path).unwrap_err());
        assert!(error.contains("half.parquet"), "{error}");
    }
}
