//! What is kept for later: within its budget, the least recently used goes first.

use caustica::kept::Kept;

fn key(number: u8) -> [u8; 32] {
    [number; 32]
}

#[test]
fn results_are_computed_once_while_they_are_kept() {
    let kept = Kept::within(100);
    let first = kept.get_or(key(1), || (vec![1, 2, 3], 40));
    let again = kept
        .clone()
        .get_or(key(1), || -> (Vec<i32>, u64) { panic!("it is kept") });
    assert_eq!(first, again);
    assert_eq!(kept.bytes(), 40);
    assert_eq!(kept.get::<Vec<i32>>(&key(2)), None);
}

#[test]
fn the_least_recently_used_goes_first() {
    let kept = Kept::within(100);
    for number in [1, 2] {
        kept.put(key(number), number, 40);
    }
    assert!(kept.get::<u8>(&key(1)).is_some());
    kept.put(key(3), 3_u8, 40);
    let held = [1, 2, 3].map(|number| kept.get::<u8>(&key(number)).is_some());
    assert_eq!(held, [true, false, true]);
    assert_eq!(kept.bytes(), 80);
}

#[test]
fn what_exceeds_the_budget_is_used_but_not_kept() {
    let kept = Kept::within(100);
    assert_eq!(*kept.put(key(1), 7_u8, 101), 7);
    assert_eq!(kept.bytes(), 0);
    assert!(kept.get::<u8>(&key(1)).is_none());
    let nothing = Kept::within(0);
    assert_eq!(*nothing.get_or(key(1), || (5_u8, 1)), 5);
    assert!(nothing.get::<u8>(&key(1)).is_none());
}

/// A second result under the same key does not count twice.
#[test]
fn a_result_stays_when_another_comes() {
    let kept = Kept::within(100);
    kept.put(key(1), 1_u8, 40);
    assert_eq!(*kept.put(key(1), 2_u8, 40), 2);
    assert_eq!(*kept.get::<u8>(&key(1)).unwrap(), 1);
    assert_eq!(kept.bytes(), 40);
}
