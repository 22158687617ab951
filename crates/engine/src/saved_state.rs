//! Saved states of monitors: compact bytes under a checksum, so that nothing damaged is taken.

use serde::Serialize;

/// A state as bytes, its checksum behind them.
pub fn sealed(state: &impl Serialize) -> Vec<u8> {
    let mut bytes = postcard::to_stdvec(state).unwrap_or_default();
    let checksum = xxhash_rust::xxh3::xxh3_64(&bytes);
    bytes.extend_from_slice(&checksum.to_le_bytes());
    bytes
}

/// The bytes without their checksum; `None` where they are damaged.
pub fn unsealed(bytes: &[u8]) -> Option<&[u8]> {
    let (body, checksum) = bytes.split_last_chunk::<8>()?;
    (xxhash_rust::xxh3::xxh3_64(body) == u64::from_le_bytes(*checksum)).then_some(body)
}
