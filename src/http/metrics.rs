//! Counters, gauges and histograms for Prometheus.

use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

use metrics::{
    Unit, counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram,
};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

use super::connections::CloseReason;
use super::state::AppState;

/// Upper bounds of the render time histogram, s.
const RENDER_BUCKETS_S: [f64; 14] = [
    0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 120.0,
];

const REQUESTS: &str = "caustica_http_requests_total";
const PROBLEMS: &str = "caustica_http_problems_total";
const CONNECTIONS: &str = "caustica_connections";
const CONNECTIONS_CLOSED: &str = "caustica_connections_closed_total";
const LOG_LINES_DROPPED: &str = "caustica_log_lines_dropped_total";
const RENDER_SECONDS: &str = "caustica_render_seconds";

/// The recorder of the process. It is installed once, since the `metrics` facade supports only one.
static RECORDER: OnceLock<PrometheusHandle> = OnceLock::new();

/// Gauges are set and read together, so that one scrape never shows the state of two.
static SCRAPE: Mutex<()> = Mutex::new(());

/// The service's side of the process-wide recorder.
#[derive(Clone, Copy, Debug)]
pub struct Metrics {
    _installed: (),
}

impl Metrics {
    /// Installs the recorder if that has not happened yet.
    pub(super) fn new() -> Self {
        handle();
        Self { _installed: () }
    }

    /// Counts a request. `status` is 499 if the client left before the answer.
    pub(super) fn request(self, method: &str, route: &str, status: u16) {
        counter!(
            REQUESTS,
            "method" => method.to_owned(),
            "route" => route.to_owned(),
            "status" => status.to_string(),
        )
        .increment(1);
    }

    /// Counts a problem by its type.
    pub(super) fn problem(self, urn: &'static str) {
        counter!(PROBLEMS, "type" => urn).increment(1);
    }

    /// Counts a connection in.
    pub(super) fn connected(self) {
        gauge!(CONNECTIONS).increment(1.0);
    }

    /// Counts a connection out.
    pub(super) fn disconnected(self) {
        gauge!(CONNECTIONS).decrement(1.0);
    }

    /// Counts a connection that the service closes.
    pub(super) fn closed(self, reason: CloseReason) {
        counter!(CONNECTIONS_CLOSED, "reason" => reason.word()).increment(1);
    }

    /// Records a finished render, from arrival to the encoded file.
    pub(super) fn rendered(self, took: Duration) {
        histogram!(RENDER_SECONDS).record(took);
    }

    /// Moves recorded samples into their buckets; call it periodically in case nothing scrapes `/metrics`.
    pub(super) fn upkeep(self) {
        handle().run_upkeep();
    }

    /// All metrics in the Prometheus text format.
    pub(super) fn render(self, state: &AppState) -> String {
        let _scrape = SCRAPE.lock().unwrap_or_else(PoisonError::into_inner);
        let status = state.queue().status();
        let settings = state.queue().settings();
        let cache = &status.level_maps;
        counter!("caustica_level_map_cache_hits_total").absolute(cache.hits);
        counter!("caustica_level_map_cache_misses_total").absolute(cache.misses);
        counter!("caustica_level_map_cache_evictions_total").absolute(cache.evictions);
        let fields = &status.fields;
        counter!("caustica_field_cache_hits_total").absolute(fields.hits);
        counter!("caustica_field_cache_misses_total").absolute(fields.misses);
        counter!("caustica_field_cache_evictions_total").absolute(fields.evictions);
        gauge!("caustica_field_cache_bytes").set(fields.bytes as f64);
        gauge!("caustica_field_cache_entries").set(fields.entries as f64);
        gauge!("caustica_field_cache_budget_bytes").set(fields.budget_bytes as f64);
        counter!("caustica_device_losses_total").absolute(status.losses);
        counter!(LOG_LINES_DROPPED).absolute(crate::log::dropped());
        gauge!("caustica_level_map_cache_bytes").set(cache.bytes as f64);
        gauge!("caustica_level_map_cache_entries").set(cache.entries as f64);
        gauge!("caustica_level_map_cache_budget_bytes").set(cache.budget_bytes as f64);
        gauge!("caustica_asset_store_bytes").set(state.fields().bytes() as f64);
        gauge!("caustica_asset_store_budget_bytes").set(state.limits().asset_store_bytes as f64);
        gauge!("caustica_queue_depth").set(state.queue().depth() as f64);
        gauge!("caustica_queue_capacity").set((settings.waiting + 1) as f64);
        gauge!("caustica_ready").set(f64::from(u8::from(state.obstacles().is_empty())));
        if let Some(adapter) = status.adapter {
            gauge!(
                "caustica_adapter_info",
                "name" => adapter.name,
                "backend" => adapter.backend,
                "driver" => adapter.driver,
                "software" => adapter.software.to_string(),
            )
            .set(1.0);
        }
        handle().render()
    }
}

fn handle() -> &'static PrometheusHandle {
    RECORDER.get_or_init(|| {
        let recorder = PrometheusBuilder::new()
            .set_buckets_for_metric(Matcher::Full(RENDER_SECONDS.to_owned()), &RENDER_BUCKETS_S)
            .expect("the list of buckets is not empty")
            .build_recorder();
        let handle = recorder.handle();
        if metrics::set_global_recorder(recorder).is_err() {
            tracing::warn!("another metrics recorder is installed; /metrics will be empty");
        }
        describe();
        // These are listed from the start, not from the first event.
        gauge!(CONNECTIONS).set(0.0);
        for reason in CloseReason::ALL {
            counter!(CONNECTIONS_CLOSED, "reason" => reason.word()).absolute(0);
        }
        handle
    })
}

fn describe() {
    describe_counter!(
        REQUESTS,
        "Requests by method, route and status; 499: the client left before the answer."
    );
    describe_counter!(
        PROBLEMS,
        "Problems by type, of answers and of warm-ups of uploads that failed."
    );
    describe_gauge!(CONNECTIONS, "Open connections.");
    describe_counter!(
        CONNECTIONS_CLOSED,
        "Connections that the service closed, by reason; idle: no request, or a part of one, for too long; evicted: the same, and \
         another connection needed the place; stalled: the client did not read its answer."
    );
    describe_counter!(
        LOG_LINES_DROPPED,
        "Log lines lost because stderr was closed, full or too slow."
    );
    describe_histogram!(
        RENDER_SECONDS,
        Unit::Seconds,
        "Time of renders from arrival to the encoded file."
    );
    describe_counter!(
        "caustica_level_map_cache_hits_total",
        "Level maps found in the cache."
    );
    describe_counter!("caustica_level_map_cache_misses_total", "Level maps built.");
    describe_counter!(
        "caustica_level_map_cache_evictions_total",
        "Level maps evicted to make room."
    );
    describe_counter!(
        "caustica_field_cache_hits_total",
        "Fields of light found in the cache."
    );
    describe_counter!("caustica_field_cache_misses_total", "Fields of light made.");
    describe_counter!(
        "caustica_field_cache_evictions_total",
        "Fields of light evicted to make room."
    );
    describe_gauge!(
        "caustica_field_cache_bytes",
        Unit::Bytes,
        "Memory of kept fields of light."
    );
    describe_gauge!("caustica_field_cache_entries", "Kept fields of light.");
    describe_gauge!(
        "caustica_field_cache_budget_bytes",
        Unit::Bytes,
        "Maximum memory of kept fields of light."
    );
    describe_counter!(
        "caustica_device_losses_total",
        "GPU devices lost or given up."
    );
    describe_gauge!(
        "caustica_level_map_cache_bytes",
        Unit::Bytes,
        "Memory of cached level maps."
    );
    describe_gauge!("caustica_level_map_cache_entries", "Cached level maps.");
    describe_gauge!(
        "caustica_level_map_cache_budget_bytes",
        Unit::Bytes,
        "Maximum memory of cached level maps."
    );
    describe_gauge!(
        "caustica_asset_store_bytes",
        Unit::Bytes,
        "Memory of uploaded assets."
    );
    describe_gauge!(
        "caustica_asset_store_budget_bytes",
        Unit::Bytes,
        "Maximum memory of uploaded assets."
    );
    describe_gauge!("caustica_queue_depth", "Jobs that wait or run.");
    describe_gauge!("caustica_queue_capacity", "Jobs that may wait or run.");
    describe_gauge!("caustica_ready", "1 when /readyz is 200.");
    describe_gauge!("caustica_adapter_info", "The adapter in use; always 1.");
}
