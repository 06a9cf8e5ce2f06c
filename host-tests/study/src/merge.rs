//! The shares of a campaign, put together. One part passes at a time: memory does not grow with the shares.

use std::path::PathBuf;

use anyhow::{Context, ensure};

use super::Store;

impl Store {
    /// Takes over what it lacks from the `shares`, folders of the same campaign, which keep what they have. A folder of another campaign is
    /// an error, and so is a part that has changed since it was written.
    pub fn merge(&self, shares: &[PathBuf]) -> anyhow::Result<()> {
        for share in shares {
            let from = Self::of_existing(share)?;
            ensure!(
                from.is_of_the_campaign_of(self),
                "{} and {}: shares of different campaigns",
                self.folder().display(),
                share.display()
            );
            let chunks = from.chunks().with_context(|| share.display().to_string())?;
            for chunk in chunks {
                if !self.has(chunk) {
                    self.take(&from, chunk)?;
                }
            }
        }
        Ok(())
    }
}
