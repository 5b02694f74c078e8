"""What a diagnosis writes: a page, the same for machines, the extended model."""
