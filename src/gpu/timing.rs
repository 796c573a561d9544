//! Time per pass. On a GPU it is measured by timestamp queries. The timestamps of a CPU driver say nothing about compute (seen on lavapipe
//! 22.3: 110 ms of spans in 750 ms of work), so there each pass is submitted alone and timed on the host. Times that cannot be trusted are
//! absent.

use super::{GpuContext, GpuError, readback};

/// Largest number of timed passes per frame. A label with any later pass gets no time at all.
const MAX_SPANS: u32 = 2048;

/// Timestamps around the passes of one frame.
#[derive(Debug)]
pub struct Timing {
    queries: Option<wgpu::QuerySet>,
    labels: Vec<&'static str>,
    /// Labels with passes beyond that limit.
    untimed: Vec<&'static str>,
    by_host: bool,
    /// The label that all passes currently count under, if any.
    group: Option<&'static str>,
    host_ms: Vec<(&'static str, f64)>,
}

impl Timing {
    /// A timing for one context.
    pub fn new(gpu: &GpuContext) -> Self {
        let by_host = gpu.adapter().software;
        let queries = (gpu.timestamps && !by_host).then(|| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timing"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MAX_SPANS,
            })
        });
        Self {
            queries,
            labels: Vec::new(),
            untimed: Vec::new(),
            by_host,
            group: None,
            host_ms: Vec::new(),
        }
    }

    /// Forgets the last frame.
    pub fn begin_frame(&mut self) {
        self.labels.clear();
        self.untimed.clear();
        self.host_ms.clear();
        self.group = None;
    }

    /// Whether each pass must be submitted alone, waited for and [noted](Self::note).
    pub fn by_host(&self) -> bool {
        self.by_host && self.group.is_none()
    }

    /// Sets whether the host may time passes if the adapter's timestamps are unusable.
    pub fn allow_host(&mut self, gpu: &GpuContext, allowed: bool) {
        self.by_host = gpu.adapter().software && allowed;
    }

    /// Whether the host times passes on this adapter at all, one by one or in groups.
    pub fn times_by_host(&self) -> bool {
        self.by_host
    }

    /// Number of passes timed so far.
    pub fn mark(&self) -> usize {
        self.labels.len()
    }

    /// Discards the passes that were recorded since a [mark](Self::mark) and will not run.
    pub fn forget_since(&mut self, mark: usize) {
        self.labels.truncate(mark);
    }

    /// From now on all passes count as `group`, and the host does not time them one by one: it [notes](Self::note) the group.
    pub fn group(&mut self, group: Option<&'static str>) {
        self.group = group;
    }

    /// Notes a pass that the host has timed.
    pub fn note(&mut self, label: &'static str, ms: f64) {
        match self.host_ms.iter_mut().find(|(l, _)| *l == label) {
            Some(sum) => sum.1 += ms,
            None => self.host_ms.push((label, ms)),
        }
    }

    /// Starts timing a pass: the query set with the indices of its begin and end, if it can be timed.
    pub fn span(&mut self, label: &'static str) -> Option<(&wgpu::QuerySet, u32, u32)> {
        let queries = self.queries.as_ref()?;
        let label = self.group.unwrap_or(label);
        let index = u32::try_from(self.labels.len()).unwrap_or(u32::MAX);
        if index >= MAX_SPANS {
            self.untimed.push(label);
            return None;
        }
        self.labels.push(label);
        Some((queries, 2 * index, 2 * index + 1))
    }

    /// Milliseconds per label, summed; a label with any span that is zero, negative or longer than `wall_ms` is left out.
    /// To be called after the frame's submission is done.
    pub fn collect(
        &self,
        gpu: &GpuContext,
        wall_ms: f64,
    ) -> Result<Vec<(&'static str, f64)>, GpuError> {
        let Some(queries) = &self.queries else {
            return Ok(self.host_ms.clone());
        };
        if self.labels.is_empty() {
            return Ok(Vec::new());
        }
        let count = 2 * u32::try_from(self.labels.len()).unwrap_or(MAX_SPANS);
        let bytes = u64::from(count) * 8;
        let resolved = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("timing"),
            size: bytes,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        // A separate submission: resolving in the submission that wrote the queries gives zeros on some Vulkan drivers.
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.resolve_query_set(queries, 0..count, &resolved, 0);
        gpu.queue.submit([encoder.finish()]);
        let ticks: Vec<u64> = readback::read(gpu, &resolved, bytes)?;
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let mut sums: Vec<(&'static str, f64, bool)> = Vec::new();
        for (label, span) in self.labels.iter().zip(ticks.chunks_exact(2)) {
            let ms = span[1]
                .checked_sub(span[0])
                .map_or(-1.0, |t| t as f64 * period_ms);
            let trusted = ms > 0.0 && ms <= wall_ms;
            match sums.iter_mut().find(|(l, ..)| l == label) {
                Some(sum) => {
                    sum.1 += ms;
                    sum.2 &= trusted;
                }
                None => sums.push((label, ms, trusted)),
            }
        }
        Ok(sums
            .into_iter()
            .filter(|(label, _, trusted)| *trusted && !self.untimed.contains(label))
            .map(|(label, ms, _)| (label, ms))
            .collect())
    }
}
