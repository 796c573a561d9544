//! The report's glossary, for readers who do not know the program.

/// Term and explanation.
pub(super) const GLOSSARY: [(&str, &str); 15] = [
    (
        "dial",
        "a setting that trades accuracy for time; a *sweep* tries several values of one dial with all else unchanged",
    ),
    (
        "truth",
        "the same scene traced ray by ray in double precision by an independent algorithm; its own error is measured by comparing two independent halves of its rays, and errors much below it cannot be measured",
    ),
    (
        "L1",
        "sum of all absolute differences from the truth, divided by the sum of the truth: the mean error, in per cent of the truth's mean",
    ),
    (
        "p99",
        "99 % of all values differ from the truth by less than this, in per cent of the truth's mean",
    ),
    (
        "FLIP",
        "the difference that people see when the two pictures alternate on a screen: 0 none, 1 the largest",
    ),
    (
        "Luv",
        "mean distance of the pictures' colours in CIE Luv; black and white are 100 apart, about 1 is just noticeable",
    ),
    (
        "bias",
        "light in excess (+) or missing (−) in total, in per cent of all light",
    ),
    (
        "energy balance",
        "the same, in comparisons of methods: light in excess (+) or missing (−) in total",
    ),
    (
        "at shadow edges",
        "share of the L1 error within two texels (for a view: pixels) of the edge of a mesh's shadow",
    ),
    (
        "estimate",
        "the render's estimate of its own L1 error, made without the truth",
    ),
    (
        "time",
        "from the scene to the finished linear picture, warm: median of the runs, with the fastest and the slowest",
    ),
    (
        "peak memory",
        "the most GPU memory that was held at one time",
    ),
    (
        "order",
        "n, when the error falls as the dial to the power −n: with order 2, twice the dial means a quarter of the error; a dial that counts halvings has a factor per level instead",
    ),
    (
        "Pareto front (★)",
        "the best settings: every faster setting has a larger error, and every more accurate setting is slower",
    ),
    (
        "signed error pictures",
        "blue where the render is too dark, red where it is too bright, white where it is right",
    ),
];
