//! Items sorted into numbered bins.

/// Items by the number of their bin, in one piece of memory.
#[derive(Clone, Debug)]
pub struct Bins<T> {
    /// Bin after bin; within a bin in the order given.
    items: Vec<T>,
    /// [bin]: place in `items` of the bin's first item; the last entry is their number.
    starts: Vec<u32>,
}

impl<T> Bins<T> {
    /// Sorts items into bins 0 to `count` - 1; the items of a bin keep their order.
    ///
    /// # Panics
    /// If `bin_of` gives a number that is not below `count`.
    pub fn new(count: usize, mut items: Vec<T>, bin_of: impl Fn(&T) -> usize) -> Self {
        items.sort_by_key(&bin_of);
        let mut starts = vec![0u32; count + 1];
        for item in &items {
            starts[bin_of(item) + 1] += 1;
        }
        for bin in 1..starts.len() {
            starts[bin] += starts[bin - 1];
        }
        Self { items, starts }
    }

    /// The items of the bins from `first` to `last` inclusive.
    #[inline]
    pub fn run(&self, first: usize, last: usize) -> &[T] {
        &self.items[self.starts[first] as usize..self.starts[last + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_of_a_bin_keep_their_order() {
        let bins = Bins::new(4, vec![31, 10, 30, 11], |item| item / 10);
        assert!(bins.run(0, 0).is_empty() && bins.run(2, 2).is_empty());
        assert_eq!(bins.run(3, 3), [31, 30]);
        assert_eq!(bins.run(0, 3), [10, 11, 31, 30]);
    }
}
