//! The buffers of a block, which its chunks share, and how long these are.

use std::ops::Range;

use crate::input::table::Table;
use crate::number::Number;
use crate::number::storage::{Column, columns};
use crate::plan::output::Output;
use crate::plan::route::{Pins, Routes};
use crate::plan::steps::{JointStep, Plan};
use crate::run::as_built_constants::BuffersAsBuilt;
use crate::run::forces::ForceBuffers;
use crate::sincos::rotation;

/// The buffers of one block, each as long as its longest chunk.
pub(crate) struct Scratch<T: Number> {
    /// The index of the current row's first element in each column of the table, and its step.
    pub(crate) cursors: Vec<(usize, usize)>,
    /// The load's columns for the current chunk; those that the plan does not need are empty, and all
    /// are until a chunk needs them.
    pub(crate) gathered: Vec<Vec<f64>>,
    /// Whether the columns with one number for all samples of the row contain it.
    pub(crate) keeps_columns: bool,
    /// Samples of the longest chunk.
    pub(crate) longest: usize,
    /// Empty until a chunk needs them.
    pub(crate) pins: [Column<T>; 2],
    /// The pins of the load, if it needs all their digits.
    pub(crate) wide_pins: [Column<T>; 2],
    pub(crate) double_sin_cos: [Column<T>; 2],
    /// The groups that replace `double_sin_cos` in a long sweep.
    pub(crate) groups: Vec<rotation::RotationGroup<T>>,
    /// Empty until then too, if they are rotated from the pins of the drive.
    pub(crate) rotated_pins: [Column<T>; 2],
    /// Whether any are.
    rotates_pins: bool,
    /// Sine and cosine of a joint's input angle, up to a common factor.
    pub(crate) turned_pins: [Column<T>; 2],
    /// Speed ratio and acceleration ratio of each shaft that the load or a cross needs.
    pub(crate) rates: Vec<[Column<T>; 2]>,
    /// Empty until a chunk needs it, as the torsion is.
    pub(crate) power: Column<T>,
    /// How many samples of `power` all chunks of the row share.
    pub(crate) kept_power: usize,
    pub(crate) torsion: Column<T>,
    pub(crate) parts: [Column<T>; 3],
    /// The first contribution to the support moment of the shaft that the load has entered.
    pub(crate) support: [Column<T>; 3],
    pub(crate) forces: ForceBuffers<T>,
    /// Angle errors of a period that is to be repeated, or of a chunk if the kernels are compact, for
    /// each shaft whose angle is requested.
    pub(crate) errors: Vec<Column<T>>,
    pub(crate) as_built: BuffersAsBuilt<T>,
}

impl<T: Number> Scratch<T> {
    pub(crate) fn new(plan: &Plan, table: &Table<'_>, longest: usize, routes: &Routes) -> Self {
        let size = |needed: bool| if needed { longest } else { 0 };
        // Most shafts of a long chain keep nothing.
        let mut rates: Vec<_> = (0..=plan.joint_count).map(|_| columns(0)).collect();
        for step in plan.shafts.iter().filter(|step| step.keep_ratio || step.keep_acceleration) {
            let kept = [step.keep_ratio, step.keep_acceleration];
            rates[step.shaft] = kept.map(|kept| Column::new(size(kept)));
        }
        let steep = plan.moving().any(|step| !plan.range(step.shaft).is_moderate());
        let wide = T::LOW && plan.needs_wide_pins();
        let needs_pins = !routes.splits() || steep || plan.needs_poses();
        let behind_chain = plan.moving().any(|step| step.shaft > 1);
        let loaded = plan.load.is_some();
        let supports = plan.joints.iter().any(JointStep::needs_support);
        Self {
            cursors: vec![(0, 0); table.columns.len()],
            gathered: if loaded { vec![vec![]; table.columns.len()] } else { vec![] },
            keeps_columns: false,
            longest,
            pins: columns(0),
            wide_pins: columns(size(wide)),
            double_sin_cos: columns(size(routes.has_double_angle())),
            groups: vec![],
            rotated_pins: columns(size(T::LOW && behind_chain)),
            rotates_pins: needs_pins && behind_chain,
            turned_pins: columns(size(wide && plan.reach() > 1)),
            rates,
            power: Column::new(0),
            kept_power: 0,
            torsion: Column::new(0),
            parts: columns(size(supports)),
            support: columns(size(supports)),
            forces: ForceBuffers::new(plan, longest),
            errors: vec![],
            as_built: BuffersAsBuilt::new(plan, longest),
        }
    }

    /// Allocates the pins and those that are rotated from them, unless they exist.
    pub(crate) fn allocate_pins(&mut self) {
        if self.pins[0].is_empty() {
            self.pins = columns(self.longest);
        }
        if self.rotates_pins && self.rotated_pins[0].is_empty() {
            self.rotated_pins = columns(self.longest);
        }
    }

    /// Allocates the power and the torsion, unless they exist.
    pub(crate) fn allocate_power(&mut self, plan: &Plan) {
        if self.power.is_empty() {
            self.power = Column::new(self.longest);
            self.torsion = Column::new(if plan.any_joint.torsion { self.longest } else { 0 });
        }
    }

    /// Gathers columns of the load for `size` samples of the row from `first` on.
    pub(crate) fn gather(
        &mut self,
        table: &Table<'_>,
        columns: Range<usize>,
        first: usize,
        size: usize,
    ) {
        for index in columns {
            let (column, (origin, step)) = (&table.columns[index], self.cursors[index]);
            let gathered = &mut self.gathered[index];
            gathered.resize(self.longest, 0.0);
            if step != 0 {
                column.read(origin + first * step, step, &mut gathered[..size]);
            } else if !self.keeps_columns {
                gathered.fill(column.data[origin]);
            }
        }
        self.keeps_columns = true;
    }

    /// Allocates angle errors for this number of samples, or none.
    pub(crate) fn keep_errors(&mut self, plan: &Plan, length: usize) {
        if self.errors.first().map_or(0, Column::len) == length {
            return;
        }
        let angles = plan.shafts.iter().filter(|step| step.planes.get(Output::Angle).is_some());
        self.errors = angles.map(|_| Column::new(length)).collect();
    }
}

/// Samples per chunk. The buffers for so many samples stay in the first-level cache, or nearly.
pub(crate) const CHUNK: usize = 1024;

/// Samples per chunk with a load, which has more buffers, and where a chunk with a very large angle is
/// repeated.
pub(crate) const SHORT_CHUNK: usize = CHUNK / 2;

/// Doubles per chunk if pins are not stored, which needs few buffers or none.
const FRESH_CHUNK: usize = 2 * CHUNK;

/// Samples per chunk of a long sweep that is computed by rotations without staging buffers.
const LONG_CHUNK: usize = 16 * CHUNK;

/// The samples per chunk of a run.
pub(crate) fn chunk_length<T: Number>(
    plan: &Plan,
    routes: &Routes,
    pins: Pins,
    staging: bool,
) -> usize {
    if pins != Pins::Stored {
        FRESH_CHUNK * size_of::<f64>() / size_of::<T::Float>()
    } else if plan.load.is_some() {
        SHORT_CHUNK
    } else if routes.has_rotation() && plan.moderate && !plan.needs_poses() && !staging {
        LONG_CHUNK
    } else if T::LOW {
        // Starting these long loops costs more than results that leave the first-level cache.
        2 * CHUNK
    } else {
        CHUNK
    }
}
