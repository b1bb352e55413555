// SPDX-License-Identifier: MIT
//! copc-levels las|copc-streaming FILE: what these crates find in a COPC file. Prints a line for each level: its number, its
//! points, and the sums of their whole-numbered coordinates.
use std::collections::BTreeMap;
use std::error::Error;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

/// Scale and offset of each axis.
type Grid = [(f64, f64); 3];

#[derive(Default)]
struct Level {
    points: u64,
    sums: [i64; 3],
}

fn grid_of(transforms: &las::Vector<las::Transform>) -> Grid {
    [&transforms.x, &transforms.y, &transforms.z].map(|t| (t.scale, t.offset))
}

fn take(level: &mut Level, grid: &Grid, x: f64, y: f64, z: f64) {
    level.points += 1;
    for (sum, (value, (scale, offset))) in level.sums.iter_mut().zip([x, y, z].into_iter().zip(grid)) {
        *sum += ((value - offset) / scale).round() as i64;
    }
}

fn by_las(path: &str) -> Result<BTreeMap<i32, Level>, Box<dyn Error>> {
    let grid = grid_of(las::Reader::from_path(path)?.header().transforms());
    let mut reader = las::CopcReader::from_path(path)?;
    let nodes: Vec<_> = reader.hierarchy_entries().filter(|node| node.point_count > 0).collect();
    let mut levels = BTreeMap::<i32, Level>::new();
    for node in nodes {
        for point in reader.read_entry(&node)?.points() {
            let point = point?;
            take(levels.entry(node.key.l).or_default(), &grid, point.x, point.y, point.z);
        }
    }
    Ok(levels)
}

/// Files are read at once, so a future is ready when it is asked.
fn finished<F: Future>(future: F) -> F::Output {
    let mut future = pin!(future);
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return output;
        }
    }
}

async fn by_streaming(path: &str) -> Result<BTreeMap<i32, Level>, Box<dyn Error>> {
    let mut reader = copc_streaming::CopcStreamingReader::open(copc_streaming::FileSource::open(path)?).await?;
    reader.load_all_hierarchy().await?;
    let transforms = reader.header().las_header().transforms();
    let grid = [&transforms.x, &transforms.y, &transforms.z].map(|t| (t.scale, t.offset));
    let nodes: Vec<_> = reader.entries().filter(|(_, node)| node.point_count > 0).map(|(key, _)| *key).collect();
    let mut levels = BTreeMap::<i32, Level>::new();
    for key in nodes {
        for point in reader.fetch_chunk(&key, copc_streaming::Fields::ALL).await?.to_points()? {
            take(levels.entry(key.level).or_default(), &grid, point.x, point.y, point.z);
        }
    }
    Ok(levels)
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let levels = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["las", path] => by_las(path)?,
        ["copc-streaming", path] => finished(by_streaming(path))?,
        _ => return Err("copc-levels las|copc-streaming FILE".into()),
    };
    for (number, level) in levels {
        println!("{number} {} {} {} {}", level.points, level.sums[0], level.sums[1], level.sums[2]);
    }
    Ok(())
}
