module field_output
  !! All field files of a run in the order that keeps them safe: first the .vtu of the step (whole or not at all), then
  !! results.vtkhdf, then the lists that ParaView opens. After a kill at any instant the earlier outputs are readable.
  use kinds, only: wp
  use extraction_set, only: extraction_set_type
  use bezier_cells, only: bezier_cells_type
  use result_frame, only: result_field_type, result_frame_type, named_text_type
  use result_folder, only: result_folder_type
  use file_system, only: rename_file, remove_file, file_exists, system_error
  use pvd_series, only: pvd_series_type
  use vtu_writer, only: write_cells, write_vertices, read_frame
  use vtkhdf_writer, only: create_vtkhdf, append_vtkhdf, resume_vtkhdf, vtkhdf_is_sound
  implicit none (type, external)
  private
  public :: field_output_type

  character(*), parameter :: hdf5_name = 'results.vtkhdf'

  type :: field_output_type
    type(bezier_cells_type) :: cells                  !! for `evaluate_element_fields`
    logical :: failed = .false.
    character(:), allocatable :: message              !! what failed, allocated if failed
    logical, private :: with_interface = .false.
    character(:), allocatable, private :: hdf5_path
    type(pvd_series_type), private :: cell_files, interface_files
  contains
    procedure :: begin
    procedure :: resume
    procedure :: write => write_output
    procedure :: has_step
    procedure, private :: note
  end type field_output_type

contains

  subroutine begin(self, folder, mesh, x, w, material, body, with_interface, provenance)
    class(field_output_type), intent(inout) :: self
    type(result_folder_type), intent(inout) :: folder
    type(extraction_set_type), intent(in) :: mesh
    real(wp), contiguous, intent(in) :: x(:, :)                        !! control points (ndm,nn) [length]
    real(wp), contiguous, intent(in) :: w(:)                           !! control weights (nn)
    integer, intent(in) :: material(:), body(:)            !! ids of the elements (ne)
    logical, intent(in) :: with_interface                  !! interface points are written too
    type(named_text_type), intent(in) :: provenance(:)

    character(:), allocatable :: message

    call prepare(self, folder, mesh, x, w, material, body, with_interface)
    call self%cell_files%begin(folder%file('fields.pvd'))
    if (with_interface) call self%interface_files%begin(folder%file('interface.pvd'))
    call create_vtkhdf(self%hdf5_path, self%cells, mesh, x, w, provenance, message)
    call self%note(message)
  end subroutine begin

  subroutine resume(self, folder, mesh, x, w, material, body, with_interface, provenance, step, time)
    !! Go on after a step: outputs after it are forgotten.
    class(field_output_type), intent(inout) :: self
    type(result_folder_type), intent(inout) :: folder
    type(extraction_set_type), intent(in) :: mesh
    real(wp), contiguous, intent(in) :: x(:, :)                        !! control points (ndm,nn) [length]
    real(wp), contiguous, intent(in) :: w(:)                           !! control weights (nn)
    integer, intent(in) :: material(:), body(:)            !! ids of the elements (ne)
    logical, intent(in) :: with_interface
    type(named_text_type), intent(in) :: provenance(:)
    integer, intent(in) :: step                            !! the last one that stands
    real(wp), intent(in) :: time                           !! its time

    character(:), allocatable :: message

    call prepare(self, folder, mesh, x, w, material, body, with_interface)
    call self%cell_files%resume(folder%file('fields.pvd'), time, message)
    call self%note(message)
    if (with_interface) call self%interface_files%resume(folder%file('interface.pvd'), time, message)
    call self%note(message)
    if (self%failed) return
    if (vtkhdf_is_sound(self%hdf5_path)) then
      call resume_vtkhdf(self%hdf5_path, self%cells, step, message)
      call self%note(message)
    else
      call write_anew(self, folder, mesh, x, w, provenance)
    end if
  end subroutine resume

  subroutine write_anew(self, folder, mesh, x, w, provenance)
    !! The HDF5 file once more, from the .vtu files; it takes its place when it is whole.
    class(field_output_type), intent(inout) :: self
    type(result_folder_type), intent(inout) :: folder
    type(extraction_set_type), intent(in) :: mesh
    real(wp), contiguous, intent(in) :: x(:, :), w(:)
    type(named_text_type), intent(in) :: provenance(:)

    character(:), allocatable :: message, new, sign
    type(result_frame_type) :: frame
    integer :: i

    new = folder%file(hdf5_name//'.new')
    call create_vtkhdf(new, self%cells, mesh, x, w, provenance, message)
    call self%note(message)
    do i = 1, self%cell_files%n
      if (self%failed) return
      call read_frame(folder%file(self%cell_files%files(i)%text), frame, message)
      call self%note(message)
      if (self%failed) return
      call append_vtkhdf(new, self%cells, frame, message)
      call self%note(message)
    end do
    if (self%failed) return
    message = ''
    sign = self%hdf5_path//'.open'
    if (.not. rename_file(new, self%hdf5_path)) then
      message = 'cannot rename a file to '//self%hdf5_path//': '//system_error()
    else if (file_exists(sign)) then
      if (.not. remove_file(sign)) message = 'cannot remove '//sign//': '//system_error()
    end if
    if (message /= '') call self%note(message)
  end subroutine write_anew

  subroutine prepare(self, folder, mesh, x, w, material, body, with_interface)
    class(field_output_type), intent(inout) :: self
    type(result_folder_type), intent(inout) :: folder
    type(extraction_set_type), intent(in) :: mesh
    real(wp), contiguous, intent(in) :: x(:, :), w(:)
    integer, intent(in) :: material(:), body(:)
    logical, intent(in) :: with_interface

    self%failed = .false.
    if (allocated(self%message)) deallocate (self%message)
    self%with_interface = with_interface
    call self%cells%init(mesh, x, w, material, body)
    self%hdf5_path = folder%file(hdf5_name)
    self%hdf5_path = folder%file(hdf5_name//'.open')
    self%hdf5_path = folder%file(hdf5_name//'.new.open')
    self%hdf5_path = folder%file(hdf5_name)
    if (folder%failed) call self%note(folder%message)
  end subroutine prepare

  subroutine write_output(self, folder, mesh, w, step, time, u, fields, points, point_fields)
    !! One output: displacement of all control values, fields of the elements, interface points.
    class(field_output_type), intent(inout) :: self
    type(result_folder_type), intent(inout) :: folder
    type(extraction_set_type), intent(in) :: mesh
    real(wp), contiguous, intent(in) :: w(:)                                !! control weights (nn)
    integer, intent(in) :: step
    real(wp), intent(in) :: time
    real(wp), intent(in) :: u(:, :)                             !! control values (ndf,nn); displacements come first
    type(result_field_type), intent(in) :: fields(:)            !! of the elements, at the points of the cells
    real(wp), contiguous, intent(in) :: points(:, :)            !! interface points (3,n) [length]
    type(result_field_type), intent(in) :: point_fields(:)      !! at them

    type(result_frame_type) :: frame
    character(:), allocatable :: message, name

    if (self%failed) return
    frame%step = step
    frame%time = time
    frame%u = u
    allocate (frame%fields(size(fields) + 1))
    frame%fields(1)%name = 'displacement'
    call self%cells%interpolate(mesh, w, u, frame%fields(1)%values)
    frame%fields(2:) = fields

    name = numbered('fields', step)
    call write_cells(folder%file(name), self%cells, frame, message)
    call self%note(message)
    if (.not. self%failed) call append_vtkhdf(self%hdf5_path, self%cells, frame, message)
    call self%note(message)
    if (.not. self%failed) call self%cell_files%add(time, name, message)
    call self%note(message)
    if (self%with_interface .and. .not. self%failed) then
      name = numbered('interface', step)
      call write_vertices(folder%file(name), time, points, point_fields, message)
      call self%note(message)
      if (.not. self%failed) call self%interface_files%add(time, name, message)
      call self%note(message)
    end if
    if (folder%failed) call self%note(folder%message)
  end subroutine write_output

  function has_step(self, step) result(yes)
    !! Whether the fields of a step are in the lists.
    class(field_output_type), intent(in) :: self
    integer, intent(in) :: step
    logical :: yes
    integer :: i

    yes = .false.
    do i = 1, self%cell_files%n
      yes = yes .or. self%cell_files%files(i)%text == numbered('fields', step)
    end do
  end function has_step

  pure function numbered(base, step) result(name)
    character(*), intent(in) :: base
    integer, intent(in) :: step
    character(:), allocatable :: name    !! fields_000020.vtu

    character(12) :: digits

    write (digits, '(i0.6)') step
    name = base//'_'//trim(digits)//'.vtu'
  end function numbered

  subroutine note(self, message)
    class(field_output_type), intent(inout) :: self
    character(:), allocatable, intent(in) :: message    !! unallocated: all is well

    if (self%failed .or. .not. allocated(message)) return
    self%failed = .true.
    self%message = message
  end subroutine note
end module field_output
