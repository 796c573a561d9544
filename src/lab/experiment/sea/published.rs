//! Figures of others, with their sources.

/// A published figure.
pub(super) struct Published {
    /// Who and where.
    pub(super) source: &'static str,
    /// How it was found.
    pub(super) how: &'static str,
    /// What it says.
    pub(super) says: &'static str,
}

/// All figures that the page sets beside ours. They are from the abstracts.
pub(super) const ALL: [Published; 4] = [
    Published {
        source: "Hieronymi & Macke, Journal of the European Optical Society – Rapid Publications 5, 10019s, 2010",
        how: "measured at sea",
        says: "the coefficient of variation is on average four times higher above 2 m than at 25 m; the wind's own waves matter down to about 5 m, below it is the height of the sea",
    },
    Published {
        source: "Hieronymi, thesis, Christian-Albrechts-Universität zu Kiel, 2011",
        how: "measured at sea, and computed",
        says: "fluctuations are strongest at 0.5 … 10 m; peaks reach 40 times the mean at 1 m, from waves of 0.2 … 5 m; the most intense ones are under winds of 2 … 7 m/s; flashes above 1.5 times the mean can appear down to 80 m",
    },
    Published {
        source: "Hieronymi & Macke, Ocean Science 8, 455–471, 2012",
        how: "computed in two dimensions, for ideal focusing: an upper limit",
        says: "the wind decides how steep the shortest waves are, and these dominate the fluctuations near the surface",
    },
    Published {
        source: "Stramski & Legendre, Marine Biology 114, 341–348, 1992",
        how: "measured in a laboratory tank, like records at sea from the top few metres",
        says: "230 flashes above 1.5 times the mean per minute, 5 … 20 ms long",
    },
];

/// Flashes per minute above 1.5 times the mean, and their lengths in ms (Stramski & Legendre 1992).
pub(super) const FLASHES_PER_MINUTE: f64 = 230.0;
/// See [`FLASHES_PER_MINUTE`].
pub(super) const FLASH_MS: [f64; 2] = [5.0, 20.0];
/// The coefficient of variation above 2 m over that at 25 m (Hieronymi & Macke 2010).
pub(super) const CV_RATIO: f64 = 4.0;
/// Peaks over the mean at 1 m (Hieronymi 2011).
pub(super) const PEAK_AT_1_M: f64 = 40.0;
/// The winds of the most intense peaks, m/s (Hieronymi 2011).
pub(super) const PEAK_WINDS_M_S: [f64; 2] = [2.0, 7.0];

/// Mean square slope of a clean sea under a wind, both directions together. Source: Cox & Munk, Journal of the Optical Society of
/// America 44, 838–850, 1954: 0.003 + 5.12·10⁻³ U ± 0.004, U in m/s.
pub(super) fn cox_munk(wind_m_s: f64) -> f64 {
    0.003 + 5.12e-3 * wind_m_s
}
