//! The level-map cache and its arena: who stays, who goes, and that ranges never overlap.

use std::collections::BTreeMap;

use caustica::level_map::{Arena, LevelMapCache};
use caustica::scene::placement::LevelMapKey;

fn key(mesh: &str, texels: u32) -> LevelMapKey {
    LevelMapKey {
        mesh: mesh.to_owned(),
        direction: [0, -(1 << 20), 0],
        texels,
        layers: 1,
    }
}

/// Bytes of a map of 16 texels a side: 4 · (16² + 2 · (256 + 64 + 16 + 4 + 1)).
const SMALL: u64 = 4 * (256 + 2 * 341);

#[test]
fn a_map_takes_a_pyramid_and_normals() {
    assert_eq!(key("a", 16).bytes(), SMALL);
    assert_eq!(key("a", 16).levels(), 5);
}

#[test]
fn a_further_layer_takes_a_depth_and_a_normal_per_texel() {
    let layered = LevelMapKey {
        layers: 3,
        ..key("a", 16)
    };
    assert_eq!(layered.bytes(), SMALL + 2 * 8 * 256);
    assert_eq!(layered.pyramid_bytes(), 4 * 2 * 341);
    // The last layer's normals end the map.
    let last = layered.pyramid_bytes() + 4 * u64::from(layered.normals_after(2));
    assert_eq!(last + 4 * 256, layered.bytes());
}

#[test]
fn what_is_there_is_a_hit() {
    let mut cache = LevelMapCache::new(4 * SMALL);
    let a = key("a", 16);
    assert_eq!(cache.reserve(&[&a]).unwrap(), std::slice::from_ref(&a));
    assert!(cache.reserve(&[&a]).unwrap().is_empty());
    let stats = cache.stats();
    assert_eq!((stats.hits, stats.misses, stats.evictions), (1, 1, 0));
    assert_eq!((stats.entries, stats.bytes), (1, SMALL));
    assert_eq!(stats.budget_bytes, 4 * SMALL);
}

#[test]
fn other_meshes_directions_and_sizes_are_other_maps() {
    let mut cache = LevelMapCache::new(64 * SMALL);
    let mut turned = key("a", 16);
    turned.direction = [1, -(1 << 20), 0];
    let keys = [key("a", 16), key("b", 16), key("a", 32), turned];
    let all: Vec<&LevelMapKey> = keys.iter().collect();
    assert_eq!(cache.reserve(&all).unwrap(), keys);
    let mut offsets: Vec<u64> = keys.iter().map(|k| cache.offset(k).unwrap()).collect();
    offsets.sort_unstable();
    offsets.dedup();
    assert_eq!(offsets.len(), keys.len());
}

#[test]
fn the_one_used_longest_ago_goes_first() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b, c) = (key("a", 16), key("b", 16), key("c", 16));
    cache.reserve(&[&a]).unwrap();
    cache.reserve(&[&b]).unwrap();
    cache.reserve(&[&a]).unwrap();
    cache.reserve(&[&c]).unwrap();
    assert!(cache.contains(&a) && !cache.contains(&b) && cache.contains(&c));
    assert_eq!(cache.stats().evictions, 1);
}

#[test]
fn what_the_frame_needs_is_never_evicted() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b, c) = (key("a", 16), key("b", 16), key("c", 16));
    cache.reserve(&[&a]).unwrap();
    cache.reserve(&[&b]).unwrap();
    // `a` is the oldest, but this frame needs it.
    assert_eq!(cache.reserve(&[&a, &c]).unwrap(), std::slice::from_ref(&c));
    assert!(cache.contains(&a) && cache.contains(&c) && !cache.contains(&b));
}

#[test]
fn more_than_the_budget_is_an_error_with_figures_and_changes_nothing() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b, c) = (key("a", 16), key("b", 16), key("c", 16));
    cache.reserve(&[&a]).unwrap();
    let error = cache.reserve(&[&a, &b, &c]).unwrap_err();
    assert_eq!(error.needed_bytes, 3 * SMALL);
    assert_eq!(error.budget_bytes, 2 * SMALL);
    let text = error.to_string();
    assert!(text.contains(&(3 * SMALL).to_string()), "{text}");
    assert!(cache.contains(&a) && !cache.contains(&b));
    assert!(cache.reserve(&[&a]).unwrap().is_empty());
}

#[test]
fn the_whole_budget_can_be_used() {
    let mut cache = LevelMapCache::new(3 * SMALL);
    let keys = [key("a", 16), key("b", 16), key("c", 16)];
    let all: Vec<&LevelMapKey> = keys.iter().collect();
    assert_eq!(cache.reserve(&all).unwrap().len(), 3);
    assert_eq!(cache.stats().bytes, 3 * SMALL);
}

#[test]
fn pieces_do_not_keep_a_map_out_that_fits() {
    // Four small ones, of which the frame keeps the second: no free range is long enough for a large one beside it.
    let large = key("large", 32);
    let mut cache = LevelMapCache::new(large.bytes() + 2 * SMALL);
    let small: Vec<LevelMapKey> = (0..6).map(|i| key(&format!("s{i}"), 16)).collect();
    for k in &small {
        let _ = cache.reserve(&[k]);
    }
    let pinned = small
        .iter()
        .filter(|k| cache.contains(k))
        .max_by_key(|k| cache.offset(k).unwrap().min(4 * SMALL))
        .unwrap();
    let missing = cache.reserve(&[pinned, &large]).unwrap();
    assert!(missing.contains(&large));
    assert!(cache.contains(pinned) && cache.contains(&large));
}

#[test]
fn forgotten_maps_are_missing_again() {
    let mut cache = LevelMapCache::new(4 * SMALL);
    let (a, b) = (key("a", 16), key("b", 16));
    cache.reserve(&[&a, &b]).unwrap();
    cache.forget(std::slice::from_ref(&a));
    assert!(!cache.contains(&a) && cache.contains(&b));
    assert_eq!(cache.stats().bytes, SMALL);
    assert_eq!(cache.reserve(&[&a]).unwrap(), std::slice::from_ref(&a));
    cache.forget(&[key("never", 16)]);
    assert_eq!(cache.stats().entries, 2);
}

#[test]
fn a_forgotten_mesh_takes_all_its_maps() {
    let mut cache = LevelMapCache::new(64 * SMALL);
    let (a, larger, b) = (key("a", 16), key("a", 32), key("b", 16));
    cache.reserve(&[&a, &larger, &b]).unwrap();
    cache.forget_mesh("a");
    assert!(!cache.contains(&a) && !cache.contains(&larger) && cache.contains(&b));
    cache.clear();
    assert_eq!(cache.stats().bytes, 0);
}

/// A small generator, the same everywhere.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) % n
    }
}

/// Bytes and pieces that are free between `held`, counted the plain way.
fn gaps(held: &BTreeMap<u64, u64>, size: u64) -> Vec<(u64, u64)> {
    let mut gaps = Vec::new();
    let mut at = 0;
    for (&offset, &bytes) in held.iter().chain(std::iter::once((&size, &0))) {
        if offset > at {
            gaps.push((at, offset - at));
        }
        at = offset + bytes;
    }
    gaps
}

#[test]
fn the_arena_agrees_with_a_plain_model() {
    const SIZE: u64 = 1000;
    let mut random = Random(7);
    let mut arena = Arena::new(SIZE);
    let mut held: BTreeMap<u64, u64> = BTreeMap::new();
    for _ in 0..20_000 {
        if random.below(2) == 0 || held.is_empty() {
            let bytes = 1 + random.below(120);
            let expected = gaps(&held, SIZE)
                .into_iter()
                .find(|&(_, length)| length >= bytes)
                .map(|(offset, _)| offset);
            let found = arena.allocate(bytes);
            assert_eq!(found, expected, "first fit of {bytes} among {held:?}");
            if let Some(offset) = found {
                held.insert(offset, bytes);
            }
        } else {
            let nth = random.below(held.len() as u64) as usize;
            let (&offset, &bytes) = held.iter().nth(nth).unwrap();
            held.remove(&offset);
            arena.free(offset, bytes);
        }
        let free = gaps(&held, SIZE);
        let sum = free.iter().map(|&(_, length)| length).sum::<u64>();
        assert_eq!(arena.free_bytes(), (sum, free.len()), "{held:?}");
    }
    arena.clear();
    assert_eq!(arena, Arena::new(SIZE));
}

#[test]
fn the_cache_holds_what_was_asked_for_whatever_went_before() {
    const BUDGET: u64 = 200_000;
    let mut random = Random(3);
    let mut cache = LevelMapCache::new(BUDGET);
    for round in 0..3000 {
        let mut keys: Vec<LevelMapKey> = (0..1 + random.below(4))
            .map(|_| key(&format!("m{}", random.below(12)), 16 << random.below(3)))
            .collect();
        keys.sort();
        keys.dedup();
        let needed: u64 = keys.iter().map(LevelMapKey::bytes).sum();
        let before: Vec<bool> = keys.iter().map(|k| cache.contains(k)).collect();
        let all: Vec<&LevelMapKey> = keys.iter().collect();
        let result = cache.reserve(&all);
        assert_eq!(result.is_err(), needed > BUDGET, "round {round}");
        let Ok(missing) = result else { continue };
        for (k, was_there) in keys.iter().zip(before) {
            assert!(cache.contains(k));
            assert!(was_there || missing.contains(k), "round {round}: not built");
        }
        let mut ranges: Vec<(u64, u64)> = keys
            .iter()
            .map(|k| (cache.offset(k).unwrap(), k.bytes()))
            .collect();
        ranges.sort_unstable();
        assert!(ranges.windows(2).all(|w| w[0].0 + w[0].1 <= w[1].0));
        assert!(
            ranges
                .iter()
                .all(|(offset, bytes)| offset + bytes <= BUDGET)
        );
        assert!(cache.stats().bytes <= BUDGET);
    }
    assert!(cache.stats().evictions > 0 && cache.stats().hits > 0);
}
