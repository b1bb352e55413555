// SPDX-License-Identifier: MIT
use pointsweep_codecs::{encode, write_chunk_table, Decoder, Layout, Source, VARIABLE_CHUNKS};

/// A generator of pseudo-random numbers, the same in every run (Steele et al. 2014).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

/// Returns random records, then records that differ little from each other, like records of a scanner.
fn records(layout: &Layout, count: usize) -> Vec<u8> {
    let mut random = SplitMix(7);
    let size = layout.record_bytes();
    let mut all: Vec<u8> = (0..count / 2 * size).map(|_| random.next() as u8).collect();
    let mut record: Vec<u8> = (0..size).map(|_| random.next() as u8).collect();
    while all.len() < count * size {
        let at = random.next() as usize % size;
        record[at] = record[at].wrapping_add(random.next() as u8 % 3);
        all.extend_from_slice(&record);
    }
    all
}

fn decoder(layout: &Layout, chunk: Vec<u8>) -> Result<Decoder<Source<impl FnMut(u64, &mut [u8]) -> std::io::Result<usize> + Send + Sync>>, pointsweep_codecs::Error> {
    let end = chunk.len() as u64;
    let read = move |offset: u64, into: &mut [u8]| {
        let part = &chunk[offset as usize..][..into.len()];
        into.copy_from_slice(part);
        Ok(part.len())
    };
    Decoder::new(layout, Source::new(read, 0, end))
}

const FORMATS: [(u8, u16); 14] =
    [(0, 0), (1, 0), (2, 0), (3, 0), (3, 7), (4, 0), (5, 2), (6, 0), (6, 5), (7, 0), (8, 0), (8, 19), (9, 0), (10, 3)];

#[test]
fn every_point_format_comes_back_as_it_was() {
    for (format, extra) in FORMATS {
        let layout = Layout::for_format(format, extra, 50_000).unwrap();
        for count in [1, 2, 3, 1000] {
            let given = records(&layout, count);
            let mut back = vec![0; given.len()];
            let mut decoder = decoder(&layout, encode(&layout, &given).unwrap()).unwrap();
            // Decodes in two parts, as readers do.
            let middle = count / 3 * layout.record_bytes();
            decoder.decode(&mut back[..middle]).unwrap();
            decoder.decode(&mut back[middle..]).unwrap();
            assert_eq!(given, back, "format {format} with {extra} extra bytes, {count} points");
        }
    }
}

#[test]
fn the_layout_written_is_the_layout_read() {
    for (format, extra) in FORMATS {
        let layout = Layout::for_format(format, extra, 12_345).unwrap();
        let read = Layout::parse(&layout.vlr()).unwrap();
        assert_eq!(read.record_bytes(), layout.record_bytes());
        assert_eq!(read.chunk_points(), 12_345);
        assert_eq!(read.is_layered(), format >= 6);
    }
}

#[test]
fn wave_packets_of_point_formats_4_and_5_have_the_version_that_laszip_knows() {
    for format in [4, 5] {
        let layout = Layout::for_format(format, 0, 50_000).unwrap();
        let versions: Vec<u16> =
            layout.items().iter().filter(|item| item.size() == 29).map(|item| item.version()).collect();
        assert_eq!(versions, [1], "format {format}");
    }
}

#[test]
fn chunk_tables_come_back_as_they_were() {
    for chunk_points in [VARIABLE_CHUNKS, 50_000] {
        let layout = Layout::for_format(6, 0, chunk_points).unwrap();
        let mut random = SplitMix(3);
        for count in [0, 1, 2, 500] {
            let chunks: Vec<_> = (0..count).map(|_| (random.next() % 70_000, 1 + random.next() % 3_000_000_000)).collect();
            let table = write_chunk_table(&layout, &chunks).unwrap();
            let read = layout.read_chunk_table(&table, count).unwrap();
            assert_eq!(read.iter().map(|c| c.1).collect::<Vec<_>>(), chunks.iter().map(|c| c.1).collect::<Vec<_>>());
            if layout.is_variable() {
                assert_eq!(read, chunks);
            }
        }
    }
}

#[test]
fn a_table_that_claims_more_chunks_than_expected_is_refused() {
    let layout = Layout::for_format(1, 0, 50_000).unwrap();
    let mut table = write_chunk_table(&layout, &[(0, 100)]).unwrap();
    table[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(layout.read_chunk_table(&table, 1).is_err());
}

#[test]
fn truncated_chunks_are_errors_or_fewer_right_records() {
    for (format, extra) in [(1, 0), (3, 2), (6, 1), (8, 0)] {
        let layout = Layout::for_format(format, extra, 50_000).unwrap();
        let given = records(&layout, 200);
        let chunk = encode(&layout, &given).unwrap();
        for end in (0..chunk.len()).step_by(7) {
            let mut back = vec![0; given.len()];
            let read = decoder(&layout, chunk[..end].to_vec()).and_then(|mut d| d.decode(&mut back));
            assert!(read.is_err() || given == back, "format {format} cut off at {end} of {}", chunk.len());
        }
    }
}

#[test]
fn damaged_chunks_and_layouts_never_panic() {
    let mut random = SplitMix(5);
    for (format, extra) in [(0, 0), (5, 3), (7, 2), (10, 1)] {
        let layout = Layout::for_format(format, extra, 50_000).unwrap();
        let chunk = encode(&layout, &records(&layout, 100)).unwrap();
        for _ in 0..300 {
            let mut damaged = chunk.clone();
            for _ in 0..1 + random.next() % 4 {
                let at = random.next() as usize % damaged.len();
                damaged[at] = random.next() as u8;
            }
            let mut back = vec![0; 100 * layout.record_bytes()];
            let _ = decoder(&layout, damaged).and_then(|mut d| d.decode(&mut back));
            let mut vlr = layout.vlr();
            let at = random.next() as usize % vlr.len();
            vlr[at] = random.next() as u8;
            let _ = Layout::parse(&vlr[..1 + random.next() as usize % vlr.len()]);
        }
    }
}
