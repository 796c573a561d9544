//! The level-map cache and its arena: which maps are kept or evicted, and that ranges never overlap.

use std::collections::{BTreeMap, BTreeSet};

use caustica::cache::{Arena, LevelMapCache};
use caustica::facts::placement::LevelMapKey;

fn key(mesh: &str, texels: u32) -> LevelMapKey {
    LevelMapKey {
        mesh: mesh.to_owned(),
        direction: [0, -(1 << 20), 0],
        texels,
        layers: 1,
    }
}

/// What a frame does: reserves, and builds what is missing.
fn frame(cache: &mut LevelMapCache, keys: &[&LevelMapKey]) -> Vec<LevelMapKey> {
    let missing = cache.reserve(keys).unwrap();
    for key in &missing {
        cache.built(key, ());
    }
    missing
}

/// Hits, misses and evictions so far.
fn counts(cache: &LevelMapCache) -> (u64, u64, u64) {
    let stats = cache.stats();
    (stats.hits, stats.misses, stats.evictions)
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
fn a_cached_map_is_a_hit() {
    let mut cache = LevelMapCache::new(4 * SMALL);
    let a = key("a", 16);
    assert_eq!(frame(&mut cache, &[&a]), std::slice::from_ref(&a));
    assert!(frame(&mut cache, &[&a]).is_empty());
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
    assert_eq!(frame(&mut cache, &all), keys);
    let mut offsets: Vec<u64> = keys.iter().map(|k| cache.offset(k).unwrap()).collect();
    offsets.sort_unstable();
    offsets.dedup();
    assert_eq!(offsets.len(), keys.len());
}

#[test]
fn the_least_recently_used_map_is_evicted_first() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b, c) = (key("a", 16), key("b", 16), key("c", 16));
    for used in [&a, &b, &a, &c] {
        frame(&mut cache, &[used]);
    }
    assert!(cache.contains(&a) && !cache.contains(&b) && cache.contains(&c));
    assert_eq!(counts(&cache), (1, 3, 1));
}

#[test]
fn what_the_frame_needs_is_never_evicted() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b, c) = (key("a", 16), key("b", 16), key("c", 16));
    frame(&mut cache, &[&a]);
    frame(&mut cache, &[&b]);
    // `a` is the oldest, but this frame needs it.
    assert_eq!(frame(&mut cache, &[&a, &c]), std::slice::from_ref(&c));
    assert!(cache.contains(&a) && cache.contains(&c) && !cache.contains(&b));
}

#[test]
fn more_than_the_budget_is_an_error_with_figures_and_changes_nothing() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b, c) = (key("a", 16), key("b", 16), key("c", 16));
    frame(&mut cache, &[&a]);
    let before = cache.stats();
    let error = cache.reserve(&[&a, &b, &c]).unwrap_err();
    assert_eq!(error.needed_bytes, 3 * SMALL);
    assert_eq!(error.budget_bytes, 2 * SMALL);
    let text = error.to_string();
    assert!(text.contains(&(3 * SMALL).to_string()), "{text}");
    assert!(cache.contains(&a) && !cache.contains(&b));
    assert_eq!(cache.stats(), before);
    assert!(frame(&mut cache, &[&a]).is_empty());
}

#[test]
fn a_budget_of_nothing_holds_nothing() {
    let mut cache = LevelMapCache::new(0);
    let error = cache.reserve(&[&key("a", 16)]).unwrap_err();
    assert_eq!((error.needed_bytes, error.budget_bytes), (SMALL, 0));
    assert!(cache.reserve(&[]).unwrap().is_empty());
}

#[test]
fn a_map_that_is_needed_twice_is_built_once() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    let (a, b) = (key("a", 16), key("b", 16));
    assert_eq!(
        frame(&mut cache, &[&a, &b, &a, &b, &a]),
        [a.clone(), b.clone()]
    );
    assert!(frame(&mut cache, &[&b, &b]).is_empty());
    assert_eq!(counts(&cache), (1, 2, 0));
    assert_eq!(cache.stats().bytes, 2 * SMALL);
    // No range has been lost.
    cache.forget_mesh("a");
    cache.forget_mesh("b");
    let whole = [key("c", 16), key("d", 16)];
    assert_eq!(frame(&mut cache, &[&whole[0], &whole[1]]).len(), 2);
    assert_eq!(cache.stats().evictions, 0);
}

#[test]
fn the_whole_budget_can_be_used() {
    let mut cache = LevelMapCache::new(3 * SMALL);
    let keys = [key("a", 16), key("b", 16), key("c", 16)];
    let all: Vec<&LevelMapKey> = keys.iter().collect();
    assert_eq!(cache.reserve(&all).unwrap().len(), 3);
    assert_eq!(cache.stats().bytes, 3 * SMALL);
}

/// A full cache of eight small maps side by side. When the fifth is kept, no free range takes `large`, though there is room.
fn fragmented(large: &LevelMapKey) -> (LevelMapCache, Vec<LevelMapKey>) {
    assert!(4 * SMALL < large.bytes() && large.bytes() < 6 * SMALL);
    let mut cache = LevelMapCache::new(8 * SMALL);
    let small: Vec<LevelMapKey> = (0..8).map(|i| key(&format!("s{i}"), 16)).collect();
    let all: Vec<&LevelMapKey> = small.iter().collect();
    frame(&mut cache, &all);
    assert_eq!(cache.offset(&small[4]), Some(4 * SMALL));
    (cache, small)
}

#[test]
fn pieces_do_not_keep_a_map_out_that_fits() {
    let large = key("large", 32);
    let (mut cache, small) = fragmented(&large);
    let kept = &small[4];
    let before = counts(&cache);
    let missing = cache.reserve(&[kept, &large]).unwrap();
    // Maps that the frame had already are built again, and the frame gets to know.
    assert_eq!(missing.len(), 2);
    assert!(missing.contains(kept) && missing.contains(&large));
    assert!(!cache.contains(kept) && !cache.contains(&large));
    for key in &missing {
        cache.built(key, ());
    }
    assert!(cache.contains(kept) && cache.contains(&large));
    // Eight were evicted, the kept one among them; it was not a hit.
    assert_eq!(counts(&cache), (before.0, before.1 + 2, before.2 + 8));
    assert_eq!(cache.stats().bytes, SMALL + large.bytes());
    // The next frame finds both.
    assert!(frame(&mut cache, &[&large, kept]).is_empty());
    assert_eq!(counts(&cache), (before.0 + 2, before.1 + 2, before.2 + 8));
}

#[test]
fn a_frame_that_moves_what_it_had_counts_every_map_once() {
    let large = key("large", 32);
    let (mut cache, small) = fragmented(&large);
    let new = key("new", 16);
    let before = counts(&cache);
    // `new` finds room at once. That it is moved again when `large` finds none is not visible outside.
    let missing = frame(&mut cache, &[&new, &small[4], &large]);
    assert_eq!(missing.len(), 3);
    assert_eq!(counts(&cache), (before.0, before.1 + 3, before.2 + 8));
}

#[test]
fn what_was_reserved_and_not_built_is_not_there() {
    let mut cache = LevelMapCache::new(4 * SMALL);
    let (a, b) = (key("a", 16), key("b", 16));
    assert_eq!(cache.reserve(&[&a]).unwrap(), std::slice::from_ref(&a));
    assert!(!cache.contains(&a));
    // Whoever forgets to forget builds it all the same, and no range is lost.
    assert_eq!(
        cache.reserve(&[&a, &b]).unwrap(),
        [a.clone(), b.clone()],
        "not built"
    );
    cache.built(&a, ());
    assert!(cache.contains(&a) && !cache.contains(&b));
    // The frame breaks off: what is whole stays.
    cache.forget_unbuilt();
    assert!(cache.contains(&a) && cache.offset(&b).is_none());
    assert_eq!(counts(&cache), (0, 1, 0));
    assert_eq!((cache.stats().entries, cache.stats().bytes), (1, SMALL));
    cache.built(&b, ());
    cache.built(&a, ());
    assert!(!cache.contains(&b), "built without a place");
    assert_eq!(counts(&cache), (0, 1, 0), "built once");
    assert_eq!(frame(&mut cache, &[&b]), std::slice::from_ref(&b));
}

#[test]
fn a_frame_that_breaks_off_leaves_room_for_all() {
    let mut cache = LevelMapCache::new(2 * SMALL);
    for round in 0..10 {
        let (a, b) = (key(&format!("a{round}"), 16), key(&format!("b{round}"), 16));
        assert_eq!(cache.reserve(&[&a, &b]).unwrap().len(), 2);
        cache.forget_unbuilt();
        assert_eq!(cache.stats().entries, 0);
    }
    assert_eq!(counts(&cache), (0, 0, 0));
}

#[test]
fn a_forgotten_mesh_takes_all_its_maps() {
    let mut cache = LevelMapCache::new(64 * SMALL);
    let (a, larger, b) = (key("a", 16), key("a", 32), key("b", 16));
    frame(&mut cache, &[&a, &larger, &b]);
    cache.forget_mesh("a");
    assert!(!cache.contains(&a) && !cache.contains(&larger) && cache.contains(&b));
    assert_eq!(cache.stats().bytes, SMALL);
    cache.forget_mesh("never");
    assert_eq!(frame(&mut cache, &[&a]), std::slice::from_ref(&a));
    assert_eq!(
        counts(&cache),
        (0, 4, 0),
        "to be deleted is not to make way"
    );
    cache.clear();
    assert_eq!((cache.stats().entries, cache.stats().bytes), (0, 0));
    assert!(!cache.contains(&b));
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

/// A simple model of the cache: which maps it has, and when each was used.
#[derive(Default)]
struct Model {
    used: BTreeMap<LevelMapKey, u64>,
    hits: u64,
    misses: u64,
}

#[test]
fn the_cache_has_the_requested_maps_after_any_history() {
    const BUDGET: u64 = 200_000;
    let mut random = Random(3);
    let mut cache = LevelMapCache::new(BUDGET);
    let mut model = Model::default();
    let mut moved = 0;
    for round in 0..6000 {
        let keys: Vec<LevelMapKey> = (0..1 + random.below(5))
            .map(|_| key(&format!("m{}", random.below(12)), 16 << random.below(3)))
            .collect();
        let distinct: BTreeSet<&LevelMapKey> = keys.iter().collect();
        let needed: u64 = distinct.iter().map(|k| k.bytes()).sum();
        let there: BTreeSet<&LevelMapKey> = distinct
            .iter()
            .copied()
            .filter(|k| cache.contains(k))
            .collect();
        for k in &there {
            assert!(model.used.contains_key(k), "round {round}: never built");
        }
        let all: Vec<&LevelMapKey> = keys.iter().collect();
        let result = cache.reserve(&all);
        assert_eq!(result.is_err(), needed > BUDGET, "round {round}");
        let Ok(missing) = result else { continue };
        let built: BTreeSet<&LevelMapKey> = missing.iter().collect();
        assert_eq!(built.len(), missing.len(), "round {round}: built twice");
        // Either what was there is used, or all is built anew.
        let expected: BTreeSet<&LevelMapKey> = distinct.difference(&there).copied().collect();
        if built != expected {
            assert_eq!(built, distinct, "round {round}");
            moved += 1;
        }
        model.hits += (distinct.len() - built.len()) as u64;
        // Now and then a frame breaks off half-way.
        let breaks_off = random.below(7) == 0;
        let whole = missing.len() / if breaks_off { 2 } else { 1 };
        for k in &missing[..whole] {
            cache.built(k, ());
            model.misses += 1;
        }
        cache.forget_unbuilt();
        for k in &distinct {
            let lost = missing[whole..].contains(k);
            assert_eq!(cache.contains(k), !lost, "round {round}");
            assert_eq!(cache.offset(k).is_some(), !lost, "round {round}");
            model.used.insert((*k).clone(), round);
        }
        // Nothing overlaps, and bytes are what is held.
        let mut ranges: Vec<(u64, u64)> = model
            .used
            .keys()
            .filter_map(|k| cache.offset(k).map(|offset| (offset, k.bytes())))
            .collect();
        ranges.sort_unstable();
        assert!(ranges.windows(2).all(|w| w[0].0 + w[0].1 <= w[1].0));
        assert!(ranges.iter().all(|(at, bytes)| at + bytes <= BUDGET));
        let stats = cache.stats();
        assert_eq!(stats.entries, ranges.len() as u64, "round {round}");
        assert_eq!(stats.bytes, ranges.iter().map(|r| r.1).sum::<u64>());
        assert_eq!((stats.hits, stats.misses), (model.hits, model.misses));
        // Every map that was built is present or was evicted.
        assert_eq!(stats.misses, stats.entries + stats.evictions);
    }
    let (hits, misses, evictions) = counts(&cache);
    println!("{hits} hits, {misses} misses, {evictions} evictions, {moved} frames moved theirs");
    assert!(hits > 0 && evictions > 0 && moved > 0);
}
