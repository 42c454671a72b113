//! Training without truth: by the energy of the cloth and of its contact with the body.

use super::unsimulated::scene;
use super::*;

#[test]
fn cloth_learns_from_its_energy_alone() {
    let (model, setup, samples) = scene();
    let samples: Vec<&Sample> = samples.iter().take(3).collect();
    let settings = Settings { epochs: Some(40), batch: 3, ..Settings::default() };
    let mut trainer = Trainer::self_supervised(model, &setup, &samples, settings).unwrap();
    assert!(trainer.unsimulated.is_some(), "limbs to mix");
    assert!(trainer.key().contains("energy 1") && trainer.key().contains("contact 1"), "{}", trainer.key());
    let sums: Vec<f32> = (0..settings.epochs()).map(|_| trainer.round(&[]).unwrap().distance).collect();
    let names: Vec<&str> = trainer.curve[0].losses.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["energy", "contact"]);
    let [first, last] = [sums[0], sums[settings.epochs() - 1]];
    assert!(last < 0.8 * first, "from {first} J to {last} J");
    assert_eq!(trainer.best_epoch().map(|best| best.distance), sums.into_iter().reduce(f32::min));
    assert!(trainer.untrained.is_none(), "no distance without a truth");
}

#[test]
fn a_teacher_learns_where_cloth_is_and_how_it_folds() {
    let (model, setup, samples) = scene();
    let samples: Vec<&Sample> = samples.iter().take(3).collect();
    let settings = Settings { epochs: Some(400), batch: 3, ..Settings::default() };
    let mut trainer = Trainer::teacher(model, &setup, &samples, settings).unwrap();
    let rows: Vec<Row> = (0..settings.epochs()).map(|_| trainer.round(&samples).unwrap()).collect();
    // Both at once: the truth of this scene is inside the body, where contact does not let the cloth go.
    for (name, share) in [("smooth", 0.95), ("energy", 0.95)] {
        // Over some epochs: each draws other poses, whose energy differs.
        let over = |part: &[Row]| part.iter().map(|row| row.loss(name).unwrap()).sum::<f32>() / part.len() as f32;
        let [first, last] = [over(&rows[..20]), over(&rows[settings.epochs() - 20..])];
        println!("{name}: from {first} to {last}");
        assert!(last < share * first, "{name}: from {first} to {last}");
    }
    assert!(rows[0].is_judged());
}
